# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Predictions beside pixels that jump: with all of their variance, and for means."""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.mixture import harmonic_variance
from cg2raw.diagnose.effects.sensor_map import SMALLEST_CHANCE
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import maps_of_jumps, predict


def predict_with_jumps(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame, with all variance of pixels that jump:
    whitening has that otherwise, by chance."""
    p = predict(model, frame)
    return replace(p, variance=p.variance + p.jumps, jumps=0.0)


def predict_for_means(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame, with the variance by which residuals
    tell of means: of pixels that jump, few that may jump far have little."""
    return for_means(predict(model, frame), model, frame)


def for_means(p: Prediction, model: Model, frame: Frame) -> Prediction:
    """Return a prediction of a model with the variance by which residuals tell of
    means."""
    for jumps in maps_of_jumps(model, frame):
        wide = p.variance + jumps.mean / np.maximum(jumps.share, SMALLEST_CHANCE)
        p = replace(p, variance=harmonic_variance(jumps.share, p.variance, wide))
    return replace(p, jumps=0.0)
