# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whitening: a model's effects turn structured noise into white noise, stage by stage,
and each says what that costs."""

from collections.abc import Iterator

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values, Whitened, WhiteningStage
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.model import Model

NO_VALUES: Values = np.zeros(0)


def whiten(z: Array, p: Prediction, model: Model, frame: Frame) -> Whitened:
    """Return residuals (T, h, w) without the structure that a model has, and the log
    of the determinant of that, per pixel.

    Offsets of rows that the ADC cuts are part of the prediction (censored_rows)."""
    read = frame.beta2 * model.noise_gain("beta2")
    cost: Array | float = 0.0
    for effect, values in _steps(model, frame):
        if effect is None:
            z, more = p.shrinkage.apply(z, frame)
        elif effect.shares_rows and frame.is_cut:
            continue
        else:
            z, more = effect.whiten(z, p, values, frame, read)
        cost = cost + more
    return z, cost


def whiten_linearly(
    z: Array, p: Prediction, model: Model, frame: Frame, rows: bool
) -> Array:
    """Return z whitened by what is linear and Gaussian; derivatives of a mean are
    whitened alike. rows : with the offsets that the pixels of a row share."""
    for effect, values in _steps(model, frame):
        if effect is None:
            z = p.shrinkage.apply(z, frame)[0]
        elif effect.linear and (rows or not effect.shares_rows):
            z = effect.whiten(z, p, values, frame, frame.beta2)[0]
    return z


def row_offsets(model: Model, frame: Frame) -> tuple[Effect, Values] | None:
    """Return the effect of what the pixels of a row share, and its values; None if they
    share nothing."""
    for effect in every().values():
        if effect.shares_rows:
            values = model.values_of(effect, frame)
            return None if values is None else (effect, values)
    return None


def _steps(model: Model, frame: Frame) -> Iterator[tuple[Effect | None, Values]]:
    """Yield effects with their values, None for the nuisance, in order."""
    for stage in WhiteningStage:
        if stage is WhiteningStage.NUISANCE and model.nuisance is not None:
            yield None, NO_VALUES
        if frame.samples is not None:
            continue  # means of many pixels are normal, and independent
        for effect in every().values():
            if effect.whitening is stage:
                values = model.values_of(effect, frame)
                if values is not None:
                    yield effect, values
