# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Curves of effects, with the interval that those of their values leave them."""

import numpy as np

from cg2raw.diagnose.effects.base import Estimates, Values
from cg2raw.diagnose.frames.tiling import Array

CURVE_POINTS = 60  # of a curve that is drawn


def curve_with_interval(
    values: Values, estimates: Estimates, design: Array
) -> tuple[Array, Array, Array]:
    """Return (y, low, high) of 1 + design @ values; intervals add as independent."""
    errors = np.array([(e.ci95[1] - e.ci95[0]) / 2 for e in estimates.values()])
    y = 1 + design @ values
    half = np.sqrt((design**2) @ errors**2)
    return y, y - half, y + half
