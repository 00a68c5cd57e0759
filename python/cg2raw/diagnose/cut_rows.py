# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Row noise of frames whose noise the ADC cuts at 0.

Pixels at 0 show of their row's offset only that it was low enough: no filter whitens
that. The offset of each row is integrated out instead, by Laplace's method: pixels that
are cut or normal, and a normal prior, are log-concave in it, and nearly normal.
"""

from dataclasses import replace

import numpy as np
from scipy.special import log_ndtr

from cg2raw.diagnose.frames import Frame
from cg2raw.diagnose.prediction import Prediction
from cg2raw.diagnose.tiling import Array
from cg2raw.diagnose.vocabulary import Values

NEWTON_STEPS = 5
LOG_ROOT_2PI = 0.5 * np.log(2 * np.pi)


def with_row_offsets(
    p: Prediction, values: Values, frame: Frame
) -> tuple[Prediction, Array]:
    """Return (prediction with each row's likeliest offset, what integrating it out adds
    to the log density, per pixel).

    values : of the effect row_noise: sigma, in read noises."""
    prior = values[0] ** 2 * frame.beta2.mean()
    offset = np.zeros((*p.mean.shape[:2], 1))
    if prior <= 0:
        return p, np.zeros_like(p.mean)
    for _ in range(NEWTON_STEPS):
        slope, bend = _derivatives(p, frame, offset)
        bend = bend + 1 / prior
        offset = offset + (slope - offset / prior) / bend
    _, bend = _derivatives(p, frame, offset)
    of_row = -0.5 * offset**2 / prior - 0.5 * np.log1p(prior * bend)
    count = np.maximum(frame.tiles.over_rows(frame.keep.astype(float)), 1)
    return replace(p, mean=p.mean + offset), of_row / count * frame.keep


def _derivatives(p: Prediction, frame: Frame, offset: Array) -> tuple[Array, Array]:
    """Return (first derivative, minus the second) of each row's log density."""
    spread = np.sqrt(p.variance)
    mean = p.mean + offset
    z = (frame.signal - mean) / spread
    end = (frame.signal + 0.5 / frame.range - mean) / spread
    log_normal = -0.5 * end**2 - LOG_ROOT_2PI
    ratio = np.exp(log_normal - log_ndtr(end))
    slope = np.where(frame.at_zero, -ratio, z) / spread
    bend = np.where(frame.at_zero, ratio * (ratio + end), 1.0) / p.variance
    # Pixels at white would show an offset as little, and are as good as none.
    used = frame.keep & ~frame.at_white
    return frame.tiles.over_rows(slope * used), frame.tiles.over_rows(bend * used)
