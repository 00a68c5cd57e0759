# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Noise of scenes and what captures have beyond it, planted, in spite of defects."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.scenes.noise import (
    excess_of,
    freedom_of,
    noise_factors,
    noise_parts,
    patch_deviation,
)
from cg2raw.diagnose.scenes.predict import photon_gain
from cg2raw.normal import MAD
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
    assert fitted(1, defects, **coding)[0] == pytest.approx([1.7, 0.6], rel=0.15)


def fitted(seed, defects=0.0, **coding):
    given = sensor_of(**coding)
    points = [at(given, kind=kind) for kind in ("dark", "flat", "scene")]
    residuals = []
    for number, point in enumerate(points):
        light = photon_gain(point.model, point.frame) * np.maximum(point.base, 0)
        variance = point.noise_variance + 0.7 * light - 0.4 * point.frame.beta2
        variance = np.broadcast_to(variance, point.root.shape)
        residuals.append(residual(variance, 3 * seed + number, defects))
    return noise_factors(points, residuals)


def test_noise_factors_are_known_by_their_information():
    """Squares of errors, by information, of two factors: chi-square of 2 on average."""
    each = [fitted(seed) for seed in range(20)]
    squares = [(f - (1.7, 0.6)) @ known @ (f - (1.7, 0.6)) for f, known in each]
    assert 1 < np.mean(squares) < 3.5


def test_chi_square_of_some_frames_has_the_error_of_noise_fitted_to_others():
    """Light alone is fitted, by m samples: means of n and of m samples differ as one of
    n * m / (n + m) does from its truth, but for what is read noise."""
    points = [at(sensor_of(), kind="flat")]
    used = points[0].root > 0
    share = (noise_parts(points[0])[0] * points[0].root ** 2)[used].mean()
    assert 0.9 < share < 1
    n = int(used.sum())
    for m in (n / 9, 10 * n):
        found = freedom_of(n, points, np.diag([m / 2, 1e15]))
        assert found == pytest.approx(n * m / (n * share**2 + m))


def excess(shift, texture, defects=0.0):
    """Return what is found of planted deviations, px and relative; samples that are
    left out show nothing."""
    points = [at(sensor_of(), kind=kind) for kind in ("flat", "scene")]
    residuals = []
    for seed, p in enumerate(points):
        slope, _ = p.frame.squared_slope_and_light
        light = np.maximum(p.base, 0)
        more = shift**2 * slope + (texture * light) ** 2
        shown = residual(p.noise_variance + more, seed, defects)
        residuals.append(np.where(p.root > 0, shown, 0.0))
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


def test_what_noise_does_to_a_patch_is_no_deviation_of_its_colour():
    """Of 25 samples of light 0.5 +- 0.05 each, a mean is known to 0.02 of it; all are
    off by that times the root of 2."""
    labels, deviation = np.repeat(np.arange(9), 25), 0.02
    light = np.full(len(labels), 0.5)
    point = SimpleNamespace(
        root=np.full(len(labels), 20.0),
        base=light,
        noise_variance=np.full(len(labels), 0.05**2),
        view=SimpleNamespace(patches=labels),
    )
    found = patch_deviation([point], [2**0.5 * deviation * light])
    assert found == pytest.approx(MAD * deviation)
