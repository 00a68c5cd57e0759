# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What flats show: planted shading and linearity, by their definitions."""

import math

import numpy as np
import pytest

from cg2raw.calibration.flats import TransferPoints, field_of, linearity
from cg2raw.calibration.sites import Sites

SHADING = {
    **{"r2": -0.3, "r4": 0.12, "r6": -0.06, "tilt_x": 0.03, "tilt_y": -0.02},
    **{"tilt_x_r2": 0.05, "tilt_y_r2": -0.04},
}


def test_each_coefficient_of_a_shading_is_found():
    """On blocks of 32 x 32, whose means are not quite those of their middles."""
    shape = (256, 320)
    half = math.hypot(*shape) / 2
    y, x = ((np.arange(n) + 0.5 - n / 2) / half for n in shape)
    v, u = np.meshgrid(y, x, indexing="ij")
    square = u**2 + v**2
    terms = (square, square**2, square**3, u, v, u * square, v * square)
    values = sum(c * one for c, one in zip(SHADING.values(), terms, strict=True))
    light = field_of(1 + values, np.ones(shape, bool), Sites(("",)))
    found = {name: one.value for name, one in light.shading.items()}
    assert found == pytest.approx(SHADING, abs=2e-3)
    assert light.fall_off.value == pytest.approx(float(np.std(values)), rel=0.02)


def points(levels, times):
    """Return photon transfer of two frames each, at DN above black."""
    one = np.ones((1, 1))
    return [
        TransferPoints(level * one, one, 0.01 * one, level, time, 2, 0.0, False)
        for level, time in zip(levels, times, strict=True)
    ]


def test_linearity_is_the_mean_deviation_of_levels_from_a_line():
    """Levels of 1000 DN a second, of which the middle one is 1 % high: deviations by
    the line of least relative squares, and their mean."""
    times = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    levels = 1000 * times * np.array([1, 1, 1.01, 1, 1])
    line = np.polynomial.Polynomial.fit(times, levels, 1, w=1 / levels)
    expected = 100 * (levels / line(times) - 1)
    found = linearity(points(levels, times), 6000.0, 1e-3, 6000.0)
    np.testing.assert_allclose(found.deviations, expected, atol=1e-6)
    assert found.deviations[2] == pytest.approx(0.8, abs=0.1)
    assert found.error.value == pytest.approx(np.abs(expected).mean())
