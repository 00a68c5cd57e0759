# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise of scenes and what captures have beyond it, planted, in spite of defects."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.scenes.noise import excess_of, noise_factors, patch_deviation
from cg2raw.diagnose.scenes.predict import photon_gain
from diagnose.planted import sensor_of
from diagnose.scenes.test_point import at


def residual(variance, seed, defects=0.0):
    """Return normal numbers of a variance (T, h, w), some of them 30 times as far."""
    rng = np.random.default_rng(seed)
    found = rng.normal(size=variance.shape) * np.sqrt(variance)
    return np.where(rng.random(variance.shape) < defects, 30 * found, found)


COARSE = {"bits": 10, "black_level": [16.0] * 4, "white_level": 1023}


@pytest.mark.parametrize(("defects", "coding"), [(0.0, {}), (0.01, {}), (0.0, COARSE)])
def test_noise_factors_are_those_of_light_and_of_the_readout(defects, coding):
    """Thousands of samples tell a variance to 3 %; the nearest of the defects, which
    look like noise, add up to a tenth. Rounding of coarse codes, a fifth of the
    read-out's, stays."""
    given = sensor_of(**coding)
    points = [at(given, kind=kind) for kind in ("dark", "flat", "scene")]
    residuals = []
    for seed, point in enumerate(points):
        light = photon_gain(point.model, point.frame) * np.maximum(point.base, 0)
        variance = point.noise_variance + 0.7 * light - 0.4 * point.frame.beta2
        residuals.append(
            residual(np.broadcast_to(variance, point.root.shape), seed, defects)
        )
    assert noise_factors(points, residuals) == pytest.approx([1.7, 0.6], rel=0.15)


def excess(shift, texture, defects=0.0):
    """Return what is found of planted deviations, px and relative."""
    points = [at(sensor_of(), kind=kind) for kind in ("flat", "scene")]
    residuals = []
    for seed, p in enumerate(points):
        slope, _ = p.frame.squared_slope_and_light
        light = np.maximum(p.base, 0)
        more = shift**2 * slope + (texture * light) ** 2
        residuals.append(residual(p.noise_variance + more, seed, defects))
    return excess_of(points, residuals)


@pytest.mark.parametrize("defects", [0.0, 0.01])
@pytest.mark.parametrize("shift", [0.0, 0.2])
@pytest.mark.parametrize("texture", [0.0, 0.03])
def test_shift_and_texture_beyond_the_noise_are_found(shift, texture, defects):
    found = excess(shift, texture, defects)
    assert found[0] == pytest.approx(shift, rel=0.1, abs=0.03)
    assert found[1] == pytest.approx(texture, rel=0.1, abs=0.008)


def test_excess_has_bounds():
    assert excess(3.0, 0.5) == pytest.approx((0.5, 0.1))
    assert excess_of([], []) == (0, 0)


def test_a_charts_deviation_is_the_patches_own_beyond_the_noise():
    """Of 400 patches; of a tenth of them the colour is another one altogether."""
    rng, patches, each, deviation = np.random.default_rng(2), 400, 25, 0.02
    labels = np.repeat(np.arange(patches), each)
    light = np.repeat(rng.uniform(0.1, 0.8, patches), each)
    noise = 1e-5 + 1e-5 * light
    off = deviation * rng.normal(size=patches)
    off[::10] = 0.5
    left = off[labels] * light + rng.normal(size=len(light)) * np.sqrt(noise)
    point = SimpleNamespace(
        root=1 / np.sqrt(noise),
        base=light,
        noise_variance=noise,
        view=SimpleNamespace(patches=labels),
    )
    found = patch_deviation([point], [left])
    # A tenth that is far off moves the median of squares by 15 %; its error is 8 %.
    assert found == pytest.approx(deviation, rel=0.25)
