# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Light that is new in every frame, where wells are full of it: a wave that dims rows
by some percent empties pixels that were expected full."""

import numpy as np
import pytest
from scipy.optimize import minimize

from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.likelihood.full_wells import (
    LIGHT_AT_REST,
    MOST_STEPS_OF_LIGHT,
    Light,
)
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    captures_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

FULL_SHARE = 0.5  # of the pixels
FLICKER = {"mains_flicker": [0.2, 30.0]}
SHADING = {"lens_shading": [-0.3]}


def flats(level=0.9):
    """Return fit frames of flats that shading makes bright in the middle alone."""
    return frames_of(sensor_of(), captures_of(("flat",) * 4, level=level))


def around_the_well(**terms):
    """Return (a model whose well cuts the middle of flats, the frames)."""
    frames = flats()
    light = predict(model_of(sensor_of(), **SHADING), frames[0]).exposed
    well = 1 - float(np.quantile(light[frames[0].counted], 1 - FULL_SHARE))
    return model_of(sensor_of(), **SHADING, full_well=[well], **terms), frames


def residuals(model, frames):
    """Return those of pixels that may be full, and of all others."""
    near, far = [], []
    for frame in frames:
        _, z, p = log_density(model, frame)
        below = p.well.surely_below
        near.append(z[frame.counted & ~below])
        far.append(z[frame.counted & below])
    return np.concatenate(near), np.concatenate(far)


def test_far_below_the_well_light_of_a_frame_moves_no_prediction():
    model, frames = around_the_well(**FLICKER)
    without = model.without("mains_flicker")
    dim = flats(level=0.2)
    for frame in drawn(dim, without, 4):
        p = predict(model, frame)
        np.testing.assert_array_equal(p.mean, predict(without, frame).mean)
        assert np.ndim(p.well.light) == 0


def test_full_pixels_without_any_noise_leave_it_a_number():
    """Of a pixel that is full for sure, only read noise would be left."""
    model, frames = around_the_well(**FLICKER)
    silent = model.with_effect(BY_NAME["read_noise"], np.array([-40.0]))
    for frame in drawn(frames, model, 5):
        p = predict(silent, frame)
        assert np.isfinite(p.mean).all() and np.isfinite(p.well.light).all()
        assert (p.variance > 0).all()


@pytest.mark.parametrize("seed", [3, 13, 14, 20, 22, 24, 40, 55])
def test_the_likeliest_light_is_found_where_pixels_contradict_each_other(seed):
    """Of pixels near the well, that are a few percent off: Newton's steps of the light
    overshoot by turns there, ever farther, unless they are held back."""
    rng = np.random.default_rng(seed)
    level, read, gain, pixels = 0.84, 1e-3, 3.5e-4, 20
    lit = rng.uniform(0.78, 1.03, pixels)
    phase = rng.choice([2.0, 3.7, 4.0], pixels)
    true = lit * (1 + 0.05 * rng.standard_normal(pixels))
    true = true + np.sqrt(gain * lit) * rng.standard_normal(pixels)
    seen = np.minimum(true, level) + read * rng.standard_normal(pixels)
    fields = 0.0156 * lit * np.array([np.cos(phase), np.sin(phase)])
    shape = (1, 1, pixels)
    well = Well(level, lit.reshape(shape), (gain * lit).reshape(shape))
    variance = (read**2 + gain * lit).reshape(shape)
    light = Light(well, fields, seen.reshape(shape), variance, np.ones(pixels))
    steps, costs = [], [light.cost]
    for _ in range(MOST_STEPS_OF_LIGHT):
        steps.append(light.step())
        costs.append(light.cost)
    assert (np.diff(costs) <= 0).all()
    assert steps[-1] < LIGHT_AT_REST and np.abs(light.numbers).max() < 4

    def cost(numbers):
        filled = well.with_more((numbers @ fields).reshape(shape))
        left = seen - (filled.charge - filled.cut[0]).ravel()
        return left**2 @ (1 / variance.ravel()) + numbers @ numbers

    assert costs[-1] == pytest.approx(minimize(cost, np.zeros(2)).fun, rel=1e-4)
