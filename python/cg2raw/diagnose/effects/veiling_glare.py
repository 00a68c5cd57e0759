# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Veiling glare: light scattered over the frame."""

from cg2raw.diagnose.effects.base import Effect, Estimates, Values
from cg2raw.diagnose.effects.sizes import percent, total


class VeilingGlare(Effect):
    name = "veiling_glare"
    title = "veiling glare"
    where = "dark regions lifted, with the mean of the scene"
    step = 2e-3
    signature = frozenset({"offset"})
    told_apart = {
        "black_level": "A dark, and flats at two levels: a gain grows with the signal, "
        "an offset does not.",
    }

    def is_possible(self, values: Values) -> bool:
        """No lens takes light from where the frame is dark."""
        return bool(values.sum() >= 0)

    def size(self, values: Estimates) -> str:
        spread = percent(total(values, "uniform", "wide"))
        return f"{spread} of the light is spread over the frame"


EFFECT = VeilingGlare()
