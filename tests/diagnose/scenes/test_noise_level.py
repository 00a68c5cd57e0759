# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise that is estimated where a profile has none."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.noise_level import ERROR_OF_MEDIAN, _line, noise_models
from diagnose.planted import bare, capture_of, changed, sensor_of, shown_set

SHAPE = (128, 160)
KINDS = ("dark", "dark", "dark", "dark", "dark", "dark", "flat", "flat", "scene")


def captures_with_pixels(sensor, kinds, seed=1):
    """Return captures whose raw is drawn from the sensor's own noise."""
    captures = [
        capture_of(kind, n, shape=SHAPE, level=0.15 + 0.07 * n)
        for n, kind in enumerate(kinds)
    ]
    return shown_set(sensor, captures, seed).captures


@pytest.mark.parametrize(
    ("read_noise", "black", "white", "kinds"),
    [
        (1.0, 256.0, 16383, KINDS),
        (3.0, 64.0, 16383, KINDS),
        (8.0, 256.0, 16383, KINDS),
        (3.125, 64.0, 1023, KINDS),  # of 0.6 DN: steps are no part of it
        (3.0, 0.0, 16383, KINDS[6:]),  # no pedestal: half of the darks' is cut off
    ],
)
def test_betas_are_those_of_the_sensor(read_noise, black, white, kinds):
    levels = {"black_level": [black] * 4, "white_level": white}
    sensor = sensor_of(5000.0, read_noise, **levels)
    captures = captures_with_pixels(sensor, kinds)
    (model,) = noise_models(CaptureSet(bare(sensor), captures)).values()
    assert not model.measured
    assert model.beta1[0] == pytest.approx(1 / 5000, rel=0.1)
    if "dark" in kinds:
        within = 0.2 if white < 9999 else 0.1
        beta2 = (read_noise / 5000) ** 2
        assert model.beta2[0] == pytest.approx(beta2, rel=within)


def test_every_iso_has_its_own():
    captures = []
    for iso, full_well in ((100.0, 8000.0), (400.0, 2000.0)):
        sensor = sensor_of(full_well, 3.0)
        for capture in captures_with_pixels(sensor, KINDS):
            captures.append(replace(capture, iso=iso, name=f"{capture.name} {iso}"))
    models = noise_models(CaptureSet(bare(sensor), captures))
    assert models[100.0].beta1[0] == pytest.approx(1 / 8000, rel=0.1)
    assert models[400.0].beta1[0] == pytest.approx(1 / 2000, rel=0.1)


def test_a_measured_noise_is_taken_as_it_is():
    sensor = sensor_of(5000.0, 3.0)
    (model,) = noise_models(CaptureSet(sensor, [capture_of()])).values()
    assert model.measured
    assert model.beta1 == pytest.approx([1 / 5000] * 4)
    assert model.beta2 == pytest.approx([(3 / 5000) ** 2] * 4)


@pytest.mark.parametrize(
    ("by", "share", "row_noise", "tails"),
    [
        ("heavy_tailed_noise", 0.02, (0.5,), (0.02, 9.0)),
        ("heavy_tailed_noise", 0.0, (0.5,), None),
        ("read_noise", 0.02, None, None),  # which draws neither rows nor tails
    ],
)
def test_noise_beyond_the_variance_is_what_its_effects_draw(
    by, share, row_noise, tails
):
    """Rows of 1.5 electrons have their part of the squares of beta2, 3^2 without."""
    beta2 = (3.0**2 + 1.5**2 * (by == "heavy_tailed_noise")) / 5000**2
    row = {"iso": 100.0, "beta1": [1 / 5000] * 4, "beta2": [beta2] * 4}
    row |= {"tukey_lambda": 0.14, "row_sigma": 1.5 / 5000}
    row |= {"outlier_fraction": share, "outlier_variance_ratio": 9.0}
    sensor = changed(sensor_of(), noise=[row], noise_effects=["shot_noise", by])
    (model,) = noise_models(CaptureSet(sensor, [capture_of()])).values()
    assert model.beta2 == pytest.approx([(3 / 5000) ** 2] * 4)
    assert model.drawn.get("row_noise") == (row_noise and pytest.approx(row_noise))
    assert model.drawn.get("heavy_tailed_noise") == tails


def test_another_cfa_takes_neighbours_of_one_color():
    """X-Trans: pixels 6 apart are of one colour, those 2 apart are not."""
    sensor = Sensor("fujifilm-x-m1")
    color = np.array(["RGB".index(c) for c in sensor.cfa]).reshape(6, 6)
    level = np.array([0.1, 0.5, 0.3])[np.tile(color, (22, 27))]
    rng = np.random.default_rng(3)
    span = sensor.signal_range
    captures = []
    for n in range(4):
        x = level * (0.3 + 0.2 * n)
        noisy = x + np.sqrt(x / 6000 + 1e-6) * rng.standard_normal(x.shape)
        raw = np.round(noisy * span + np.mean(sensor.black_level)).astype(np.uint16)
        captures.append(capture_of("flat", n, shape=raw.shape, raw=lambda raw=raw: raw))
    (model,) = noise_models(CaptureSet(sensor, captures)).values()
    assert model.beta1[0] == pytest.approx(1 / 6000, rel=0.1)


def test_too_few_pixels_say_so():
    raw = np.full((8, 8), 300, np.uint16)
    captures = [capture_of("dark", shape=raw.shape, raw=lambda: raw)]
    with pytest.raises(ValueError, match="give a profile with noise, and iso"):
        noise_models(CaptureSet(bare(sensor_of()), captures))


def test_levels_with_edges_in_them_hardly_count():
    level = np.linspace(0.02, 0.9, 20)
    variance = 2e-4 * level + 1e-6
    variance[[4, 11, 16]] *= 30
    slope, offset = _line(level, variance, np.full(20, 4000.0))
    assert (slope, offset) == pytest.approx((2e-4, 1e-6), rel=0.02)


def test_the_error_of_a_median_is_that_of_normal_numbers():
    """2000 draws tell a variance to 3 %."""
    normal = np.random.default_rng(4).normal(size=(2000, 400))
    variances = np.square(np.median(np.abs(normal), axis=1) / 0.6745)
    assert ERROR_OF_MEDIAN == pytest.approx(400 * np.log(variances).var(), rel=0.1)
