# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The detection limit gains, when it is drawn, what a name has to gain."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.heavy_tailed_noise import NOISY
from cg2raw.diagnose.inference.detection_limits import detection_limits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    shown,
)

SENSOR = sensor_of()
NEEDED = np.log(1 / 0.01)
SEEDS = 8
TOLERANCE = 4 * np.sqrt(2 * NEEDED / SEEDS)


def captured(group="select"):
    kinds = ("dark", "dark", "flat", "scene")
    return [
        capture_of(kind, seed, group=group, name=f"{group}-{seed}")
        for seed, kind in enumerate(kinds)
    ]


@pytest.fixture(scope="module")
def frames():
    return frames_of(SENSOR, captured())


@pytest.fixture(scope="module")
def fitted():
    return frames_of(SENSOR, captured("fit"))


def strength_of(name, frames, model=None, fitted=()):
    model = model or Model(SENSOR)
    effects = [BY_NAME[name]]
    (limit,) = detection_limits(model, effects, on(frames), on(fitted), 0.01)
    return limit.strength


def mean_gain(frames, best, draw):
    gains = [
        on(seen).total(best) - on(seen).total(Model(SENSOR))
        for seen in (draw(seed) for seed in range(SEEDS))
    ]
    return np.mean(gains)


def noisy(frames, seed, noise_of, model=None):
    """Return frames with noise_of(rng, prediction, frame) on what a model predicts."""
    result = []
    for number, frame in enumerate(frames):
        rng = np.random.default_rng([seed, number])
        p = predict(model or Model(SENSOR), frame)
        result.append(shown(frame, p.mean + noise_of(rng, p, frame)))
    return result


def test_an_exposure(frames):
    strength = strength_of("exposure", frames)
    best = model_of(SENSOR, exposure=[strength])
    gain = mean_gain(frames, best, lambda seed: drawn(frames, best, 20 + seed))
    assert gain == pytest.approx(NEEDED + 0.5, abs=TOLERANCE)


def test_row_noise(frames):
    sigma = strength_of("row_noise", frames)
    read = np.sqrt(np.mean([frame.beta2.mean() for frame in frames]))
    best = model_of(SENSOR, row_noise=[sigma / read])

    def rows(frame, rng):
        return sigma * rng.standard_normal((1, frame.signal.shape[1], 1))

    def draws(seed):
        return drawn(frames, Model(SENSOR), seed, rows)

    assert mean_gain(frames, best, draws) == pytest.approx(NEEDED, abs=TOLERANCE)


def test_heavy_tails(frames):
    fraction = strength_of("heavy_tailed_noise", frames)
    best = model_of(SENSOR, heavy_tailed_noise=[fraction, NOISY])

    def noise(rng, p, frame):
        core = frame.beta2 / (1 + fraction * (NOISY - 1))
        wide = rng.random(p.mean.shape) < fraction
        read = np.sqrt(np.where(wide, NOISY, 1) * core)
        photons = np.sqrt(np.maximum(p.variance - frame.beta2, 0))
        normal = rng.standard_normal((2, *p.mean.shape))
        return read * normal[0] + photons * normal[1]

    def draws(seed):
        return noisy(frames, seed, noise)

    assert mean_gain(frames, best, draws) == pytest.approx(NEEDED, abs=2 * TOLERANCE)


def test_noise_reduction(frames):
    blend = strength_of("noise_reduction", frames)
    best = model_of(SENSOR, noise_reduction=[blend, 0])

    def draws(seed):
        return noisy(frames, seed, noise, best)

    def noise(rng, p, frame):
        z = rng.standard_normal(p.mean.shape)
        near = sum(np.roll(z, by, axis) for by in (-2, 2) for axis in (1, 2)) / 4
        z = (1 - blend) * z + blend * near
        return np.sqrt(p.variance) * z / np.sqrt((1 - blend) ** 2 + blend**2 / 4)

    assert mean_gain(frames, best, draws) == pytest.approx(NEEDED, abs=TOLERANCE)


def test_photons_show_in_the_dim_frames_only():
    """Ten times the electrons, ten times less skewness squared."""
    few, many = (
        strength_of(
            "poisson_shot_noise", frames_of(sensor, [capture_of("scene", 3)] * 100)
        )
        for sensor in (sensor_of(), sensor_of(20000.0))
    )
    assert few is not None
    assert many is None or many > 1.5 * few


def test_a_well_above_the_brightest_pixel_is_not_visible():
    (dark,) = frames_of(SENSOR, [capture_of("dark", 1)])
    assert strength_of("full_well", [dark]) is None
    (flat,) = frames_of(SENSOR, [capture_of("flat", 1, level=0.6)])
    brightest = predict(Model(SENSOR), flat).mean.max()
    well = 1 - strength_of("full_well", [flat])
    assert well == pytest.approx(brightest, abs=0.02)


def test_strengths_that_the_model_takes_up_are_not_visible():
    """In a flat of one level, brightness that is fitted hides a curved response."""
    (flat,) = frames_of(SENSOR, [capture_of("flat", 1)])
    alone = strength_of("nonlinearity", [flat])
    beside = strength_of("nonlinearity", [flat], model_of(SENSOR, exposure=[0.0]))
    assert beside is None or beside > 3 * alone
