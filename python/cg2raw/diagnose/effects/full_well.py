# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Full well: charge clips below white."""

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Estimates,
    Gain,
    Predicted,
)
from cg2raw.diagnose.effects.sizes import percent, value_of

BRIGHT = 0.2  # of white, from which on pixels may be clipped


class FullWell(Effect):
    name = "full_well"
    title = "full well below white"
    where = "levels pile up below white"
    bounds = {"below_white": (-0.7, 0.7)}  # on top of what a profile has
    signature = frozenset({"gain"})
    from_means = True

    def expected_gain(self, selected: Predicted) -> Gain:
        """A bright pixel stands at the well in place of where it was expected."""
        bright = [
            (p.mean[used], p.variance[used])
            for frame, p in selected
            for used in [frame.keep & ~frame.at_white & (p.mean > BRIGHT)]
        ]

        def gain(below_white: float) -> float:
            return sum(
                float((np.maximum(x - (1 - below_white), 0) ** 2 / v).sum()) / 2
                for x, v in bright
            )

        return gain

    def size(self, values: Estimates) -> str:
        return f"charge clips {percent(value_of(values, 'below_white'))} below white"


EFFECT = FullWell()
