# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pixels that jump: what they tell of means, and all of their variance."""

import numpy as np

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.likelihood.jumps import predict_for_means, predict_with_jumps
from cg2raw.diagnose.likelihood.model import Term
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import BY_NAME, SHAPE, capture_of, frames_of, model_of, sensor_of


def test_a_pixel_that_hardly_jumps_tells_of_means_as_others_do():
    """By the harmonic mean: its variance over all frames is ten times theirs."""
    (frame,) = frames_of(sensor_of(), [capture_of("dark", group="select")])
    bare = predict(model_of(sensor_of()), frame).variance
    chance = np.full((1, *SHAPE), 0.1)
    known = SensorMap(9 * bare, np.zeros_like(bare), chance=chance)
    effect = BY_NAME["random_telegraph_noise"]
    model = model_of(sensor_of()).with_term(Term(effect, np.ones(2), known))
    told = predict_for_means(model, frame).variance
    np.testing.assert_allclose(told, bare / (0.9 + 0.1 / 91))
    np.testing.assert_allclose(predict_with_jumps(model, frame).variance, 10 * bare)
