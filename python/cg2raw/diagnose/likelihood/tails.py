# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Tails: of read noise a share is wider, and what goes by squares has to know it."""

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.mixture import harmonic_variance, log_odds
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.model import Model

LEAST_CORE = 0.1  # of a variance


@dataclass(frozen=True)
class Tails:
    """A share of residuals is outlying: their variance is `wide`, of others `narrow`,
    both (T, h, w)."""

    outlying: float
    narrow: Array
    wide: Array

    def variance_of(self, residual: Array, more: Array | float = 0.0) -> Array:
        """Return the variance that each residual (T, h, w) counts with: the harmonic
        mean of both kinds', by the chances that it is of either.

        more : variance that residuals have beside, as of charge that is known; below 0
        where there is less."""
        narrow, wide = (
            np.maximum(own + more, LEAST_CORE * own) for own in (self.narrow, self.wide)
        )
        odds = log_odds(residual, self.outlying, narrow, wide)
        return harmonic_variance(expit(odds), self.narrow, self.wide)


def tails_of(model: Model, frame: Frame) -> tuple[float, float]:
    """Return (share, variance ratio) of noise that is wider than the rest."""
    for effect in every().values():
        values = model.values_of(effect, frame) if effect.whitening else None
        tails = None if values is None else effect.tails(values)
        if tails is not None:
            return tails
    return 0.0, 1.0


def tails_in(model: Model, frame: Frame, p: Prediction) -> Tails | None:
    """Return the tails of a frame's noise; None if it has none."""
    return _tails(model, frame, p.variance, p.kept)


def variance_for_means(model: Model, frame: Frame, variance: Array) -> Array:
    """Return the variance by which residuals of a variance (T, h, w) tell of means."""
    tails = _tails(model, frame, variance)
    if tails is None:
        return variance
    return harmonic_variance(tails.outlying, tails.narrow, tails.wide)


def _tails(
    model: Model, frame: Frame, variance: Array, kept: Array | float = 1.0
) -> Tails | None:
    outlying, ratio = tails_of(model, frame)
    if outlying <= 0 or ratio <= 1:
        return None
    read = kept * frame.beta2 * model.noise_gain("beta2")
    core = read / (1 + outlying * (ratio - 1))
    narrow = np.maximum(variance - read + core, LEAST_CORE * variance)
    return Tails(outlying, narrow, narrow + (ratio - 1) * core)
