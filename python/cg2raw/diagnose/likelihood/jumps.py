# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Predictions beside pixels that jump: with all of their variance, and for means."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.mixture import harmonic_variance
from cg2raw.diagnose.effects.sensor_map import SMALLEST_CHANCE
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict


def predict_with_jumps(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame, with all variance of pixels that jump:
    whitening has that otherwise, by chance."""
    p = predict(model, frame)
    for jumps in _maps_of_jumps(model, frame):
        p = replace(p, variance=p.variance + jumps.mean)
    return p


def predict_for_means(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame, with the variance by which residuals
    tell of means: of pixels that jump, few that may jump far have little."""
    p = predict(model, frame)
    for jumps in _maps_of_jumps(model, frame):
        wide = p.variance + jumps.mean / np.maximum(jumps.share, SMALLEST_CHANCE)
        p = replace(p, variance=harmonic_variance(jumps.share, p.variance, wide))
    return p


def _maps_of_jumps(model: Model, frame: Frame) -> Iterator[SensorMap]:
    """Yield the maps of variance that whitening has."""
    for term, effect, _ in model.maps:
        known = model.map_on(term.effect, frame) if effect.whitens_variance else None
        if known is not None:
            yield known
