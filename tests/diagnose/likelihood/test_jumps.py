# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pixels that jump: what they tell of means and of their neighbours, and all of their
variance."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.likelihood.jumps import predict_for_means, predict_with_jumps
from cg2raw.diagnose.likelihood.model import Term
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    SHAPE,
    capture_of,
    frames_of,
    model_of,
    on,
    sensor_of,
)


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


@pytest.mark.parametrize("sigma", [0.5, 2.0])
def test_pixels_that_jump_tell_hardly_of_the_offset_of_their_row(sigma):
    """The density of rows is that of a dense normal, of which pixels that surely jump
    have as much more variance: else one that is 30 deviations off moves its row."""
    (frame,) = frames_of(sensor_of(), [capture_of("dark", group="select")])
    rng = np.random.default_rng(3)
    model = model_of(sensor_of(), row_noise=[sigma])
    bare = predict(model, frame)
    jumps = np.where(rng.random(bare.mean.shape) < 0.05, 900 * bare.variance, 0)
    known = SensorMap(jumps, np.zeros_like(jumps), chance=(jumps > 0).astype(float))
    effect = BY_NAME["random_telegraph_noise"]
    model = model.with_term(Term(effect, np.array([0.05, 0.1]), known))
    spread = np.sqrt(bare.variance + jumps)
    signal = bare.mean + spread * rng.standard_normal(spread.shape)
    frame = replace(frame, signal=signal)
    offset = BY_NAME["row_noise"].offset_variance(np.array([sigma]), frame)

    def of_rows(offset):
        total = 0.0
        for row in np.flatnonzero(frame.keep[0].any(1)):
            at = np.s_[0, row, frame.keep[0, row]]
            covariance = np.diag(spread[at] ** 2) + offset
            away = signal[at] - bare.mean[at]
            total += multivariate_normal(cov=covariance).logpdf(away)
        return total

    gained = on([frame]).total(model) - on([frame]).total(model.without("row_noise"))
    assert gained == pytest.approx(of_rows(offset) - of_rows(0.0), rel=1e-6)


@pytest.mark.parametrize("coefficient", [0.06, -0.2])
def test_pixels_that_jump_tell_hardly_of_the_noise_of_the_next(coefficient):
    """The likeliest correlation is the true one, to three standard errors."""
    (frame,) = frames_of(
        sensor_of(), [capture_of("dark", group="select", shape=(300, 400))]
    )
    rng = np.random.default_rng(4)
    model = model_of(sensor_of(), read_noise_correlation=[coefficient])
    bare = predict(model, frame)
    jumps = np.where(rng.random(bare.mean.shape) < 0.02, 400 * bare.variance, 0)
    known = SensorMap(jumps, np.zeros_like(jumps), chance=(jumps > 0).astype(float))
    effect = BY_NAME["random_telegraph_noise"]
    model = model.with_term(Term(effect, np.array([0.02, 0.1]), known))
    noise = rng.standard_normal(bare.mean.shape)
    for col in range(1, noise.shape[2]):
        noise[..., col] *= np.sqrt(1 - coefficient**2)
        noise[..., col] += coefficient * noise[..., col - 1]
    signal = bare.mean + np.sqrt(bare.variance) * noise
    signal += np.sqrt(jumps) * rng.choice([-1.0, 1.0], jumps.shape)
    shown = on([replace(frame, signal=signal)])
    tried = coefficient + np.linspace(-0.03, 0.03, 13)
    whitened = BY_NAME["read_noise_correlation"]
    heights = [shown.total(model.with_effect(whitened, np.array([c]))) for c in tried]
    error = 1 / np.sqrt(frame.keep.sum())
    assert abs(tried[np.argmax(heights)] - coefficient) < 3 * error + 0.0025
