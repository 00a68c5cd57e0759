# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""White balance: gains of red and blue."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.exposure import KNOWN_LIGHT
from cg2raw.diagnose.effects.sizes import value_of


class WhiteBalance(Effect):
    name = "white_balance"
    title = "white balance"
    where = "in proportion to signal, in red and blue, greys too"
    signature = frozenset({"mixer"})
    told_apart = {"gr_gb_imbalance": KNOWN_LIGHT}

    def size(self, values: Estimates) -> str:
        return (
            f"red is {value_of(values, 'red'):+.2%} and blue "
            f"{value_of(values, 'blue'):+.2%} off what the model says"
        )


EFFECT = WhiteBalance()
