# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Row noise of frames whose noise the ADC cuts at 0.

Pixels at 0 show of their row's offset only that it was low enough: no filter whitens
that. The offset of each row is integrated out instead, by Laplace's method: pixels that
are cut or normal, and a normal prior, are log-concave in it, and nearly normal.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censoring import scores

NEWTON_STEPS = 10
LEAST_CHANCE = 1e-12


@dataclass(frozen=True)
class CensoredRows:
    """A prediction with the offsets of a frame's rows.

    likeliest : for densities. drawn : with offsets from their posterior, for residuals,
    which are standard normal then. log_density : what integrating the offsets out adds,
    per pixel."""

    likeliest: Prediction
    drawn: Prediction
    log_density: Array


def censored_rows(p: Prediction, values: Values, frame: Frame) -> CensoredRows:
    """Return a prediction with row offsets. values : of row_noise: sigma, in read
    noises."""
    prior = values[0] ** 2 * frame.beta2.mean()
    offset = np.zeros((*p.mean.shape[:2], 1))
    if prior <= 0:
        return CensoredRows(p, p, np.zeros_like(p.mean))
    for _ in range(NEWTON_STEPS):
        slope, bend = _derivatives(p, frame, offset)
        bend = bend + 1 / prior
        offset = offset + (slope - offset / prior) / bend
    _, bend = _derivatives(p, frame, offset)
    of_row = -0.5 * offset**2 / prior - 0.5 * np.log1p(prior * bend)
    count = np.maximum(frame.tiles.over_rows(frame.keep.astype(float)), 1)
    # A sum of uniform numbers is uniform on the circle, and tiles of a row share it.
    turn = frame.tiles.over_rows(frame.uniform[:, :, :1]) % 1
    away = ndtri(np.clip(turn, LEAST_CHANCE, 1 - LEAST_CHANCE)) / np.sqrt(
        bend + 1 / prior
    )
    return CensoredRows(
        replace(p, mean=p.mean + offset),
        replace(p, mean=p.mean + offset + away),
        of_row / count * frame.keep,
    )


def _derivatives(p: Prediction, frame: Frame, offset: Array) -> tuple[Array, Array]:
    """Return (first derivative, minus the second) of each row's log density."""
    z, _, weight = scores(replace(p, mean=p.mean + offset), frame)
    # Pixels at white would show an offset as little, and are as good as none.
    used = np.where(frame.keep & ~frame.at_white, weight, 0) / np.sqrt(p.variance)
    return frame.tiles.over_rows(used * z), frame.tiles.over_rows(used**2)
