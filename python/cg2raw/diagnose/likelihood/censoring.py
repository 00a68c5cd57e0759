# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Censoring: what pixels say that the ADC cuts at one of its ends."""

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array, Mask

LOG_2PI = np.log(2 * np.pi)
LARGEST_Z = 8.0
LEAST_INFORMATION_SHARE = 1e-6  # of the information of a pixel that is not censored
UNCLIPPED = 0.95  # of white, up to which noise does not reach it
DRAWN_ABOVE = 0.97  # of white; above it residuals are drawn, not measured


def residuals(p: Prediction, frame: Frame) -> Array:
    """Return standardised residuals; those of censored pixels are drawn from what the
    model leaves possible. Source: P. K. Dunn, G. K. Smyth, J. Comput. Graph. Stat.
    5(3), 1996."""
    spread = np.sqrt(p.variance)
    z = (frame.signal - p.mean) / spread
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if not hit.any():
            continue
        end = first_censored(frame, hit, sign, p) / spread[hit]
        low = ndtr(end)
        drawn = ndtri(low + frame.uniform[hit] * (1 - low))
        drawn = np.clip(drawn, -LARGEST_Z, LARGEST_Z)
        z[hit] = sign * np.where(low > 1 - 1e-14, end, drawn)
    return z


def first_censored(frame: Frame, hit: Mask, sign: float, p: Prediction) -> Array:
    """Return the way from the mean to what is rounded to the ADC's end."""
    half = 0.5 / np.broadcast_to(frame.range, hit.shape)[hit]
    return sign * (frame.signal[hit] - p.mean[hit]) - half


def scores(p: Prediction, frame: Frame) -> tuple[Array, Array, Array]:
    """Return (score of the mean, of the variance, weight) of every pixel.

    The mean's is its residual, times its weight; the variance's is of its log, times
    the root of 2. weight : root of a pixel's information on its mean, 1 but of those
    that are cut at an end of the ADC: they say that they lie beyond it, and the score
    of their mean is the inverse of Mills' ratio."""
    spread = np.sqrt(p.variance)
    z = np.where(frame.counted, (frame.signal - p.mean) / spread, 0)
    square = (z * z - 1) * np.sqrt(0.5)
    weight = np.ones_like(z)
    for hit, sign in ((frame.at_white, 1.0), (frame.at_zero, -1.0)):
        if hit.any():
            end = first_censored(frame, hit, sign, p) / spread[hit]
            ratio = np.exp(-0.5 * end**2 - 0.5 * LOG_2PI - log_ndtr(-end))
            told = np.sqrt(np.clip(ratio * (ratio - end), LEAST_INFORMATION_SHARE, 1))
            z[hit], weight[hit] = sign * ratio / told, told
            square[hit] = np.sqrt(0.5) * ratio * end
    return z, square, weight
