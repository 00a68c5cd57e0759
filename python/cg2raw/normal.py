# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is known of normal numbers, and their spread where some are none."""

import numpy as np
from numpy.typing import NDArray

CI95 = 1.959964  # standard errors to each side that hold 95 %
ABOVE95 = 1.644854  # standard errors below the mean, above which 95 % lie
MAD = 1.4826  # standard deviations in a median of absolute deviations
# Of samples, on average, from which on their number is taken for normal. Source: W. G.
# Cochran, Ann. Math. Statist. 23(3), 1952 (counts of a chi-square test).
FEWEST_COUNT = 5.0
TUKEY_LAMBDA = 0.14  # of the distribution of Tukey's that is nearest to a normal one


def robust_deviation(
    values: NDArray[np.floating], middle: float | None = None
) -> float:
    """Return the standard deviation, by the median of absolute deviations.

    values : any shape, one at least. middle : what they deviate from, their median if
    None."""
    if middle is None:
        middle = float(np.median(values))
    return MAD * float(np.median(np.abs(values - middle)))
