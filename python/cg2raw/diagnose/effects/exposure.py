# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Exposure: one gain for all light."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import percent, value_of

KNOWN_LIGHT = "A flat under a known light: exposure moves all colours alike."
TWO_LEVELS = (
    "A dark, and flats at two levels: a gain grows with the signal, an offset does not."
)


class Exposure(Effect):
    name = "exposure"
    title = "exposure"
    where = "in proportion to signal, all channels alike"
    signature = frozenset({"gain"})
    from_means = True
    told_apart = {
        "white_balance": KNOWN_LIGHT,
        "gr_gb_imbalance": KNOWN_LIGHT,
        "veiling_glare": TWO_LEVELS,
        "black_level": TWO_LEVELS,
    }

    def size(self, values: Estimates) -> str:
        gain = value_of(values, "gain")
        side = "brighter" if gain > 0 else "darker"
        return f"everything is {percent(abs(gain))} {side}"


EFFECT = Exposure()
