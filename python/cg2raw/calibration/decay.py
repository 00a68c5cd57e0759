# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Decay: least squares of a straight part and an exponential of unknown length.

Lengths are tried on a grid; from the best one Gauss and Newton go on, and the errors of
height and length are those of both together.
"""

from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.robust import CUT, Array, clipped_moments

ROUNDS = 12
LARGEST_STEP = 0.3  # of the logarithm of the length in one round


@dataclass(frozen=True)
class Decay:
    """values, errors : of the straight part's columns, then height, then length.
    rest : y less the fit. variance : of the rest without what lies 4 sigma off."""

    values: Array
    errors: Array
    rest: Array
    variance: float

    @property
    def length(self) -> float:
        return float(self.values[-1])


def fit_decay(
    straight: Array, distance: Array, y: Array, lengths: Array, first: int = 0
) -> Decay:
    """Return the robust least squares of straight @ a + height exp(-distance / length).

    straight : (N, k). distance : (N,), and lengths to try in its unit. first : how many
    of y count however far off they are: the decay may be of them alone."""
    best = min((squares_of(straight, distance, y, x), x) for x in lengths)
    length, keep = float(best[1]), np.ones(len(y), bool)
    low, high = float(lengths[0]), float(lengths[-1])
    for _ in range(ROUNDS):
        fall = np.exp(-distance / length)
        linear = np.column_stack([straight, fall])
        values = np.linalg.lstsq(linear[keep], y[keep], rcond=None)[0]
        rest = y - linear @ values
        by_log = values[-1] * fall * distance / length
        both = np.column_stack([linear, by_log])
        step = np.linalg.lstsq(both[keep], rest[keep], rcond=None)[0][-1]
        step = float(np.clip(step, -LARGEST_STEP, LARGEST_STEP))
        length = min(max(length * np.exp(step), low), high)
        keep = np.abs(rest) <= CUT * clipped_moments(rest)[1]
        keep[:first] = True
        if abs(step) < 1e-4:
            break
    freedom = max(int(keep.sum()) - both.shape[1], 1)
    variance = float((rest[keep] ** 2).sum()) / freedom
    covariance = np.linalg.pinv(both[keep].T @ both[keep]) * variance
    errors = np.sqrt(np.maximum(np.diag(covariance), 0))
    errors[-1] *= length
    return Decay(np.append(values, length), errors, rest, variance)


def squares_of(straight: Array, distance: Array, y: Array, length: float) -> float:
    """Return the sum of squares that a length leaves, residuals cut at 4 sigma."""
    design = np.column_stack([straight, np.exp(-distance / length)])
    rest = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
    most = CUT * clipped_moments(rest)[1]
    keep = np.abs(rest) <= most
    if keep.sum() > design.shape[1]:
        again = np.linalg.lstsq(design[keep], y[keep], rcond=None)[0]
        rest = y - design @ again
    clipped = np.clip(rest, -most, most)
    return float(clipped @ clipped)
