# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What flats show: planted shading and linearity, by their definitions."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.calibration.darks import DarkCurrent, DarkResults
from cg2raw.calibration.flats import (
    FULL_WELL,
    PhotonTransfer,
    TransferPoints,
    above_darks,
    field_of,
    lamp_drift,
    linearity,
)
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites

SHADING = {
    **{"r2": -0.3, "r4": 0.12, "r6": -0.06, "tilt_x": 0.03, "tilt_y": -0.02},
    **{"tilt_x_r2": 0.05, "tilt_y_r2": -0.04},
}


def test_each_coefficient_of_a_shading_is_found():
    """On blocks of 32 x 32, whose means are not quite those of their middles; one pixel
    of each is not known, and all of one block."""
    shape = (256, 320)
    half = math.hypot(*shape) / 2
    y, x = ((np.arange(n) + 0.5 - n / 2) / half for n in shape)
    v, u = np.meshgrid(y, x, indexing="ij")
    square = u**2 + v**2
    terms = (square, square**2, square**3, u, v, u * square, v * square)
    values = sum(c * one for c, one in zip(SHADING.values(), terms, strict=True))
    known = np.ones(shape, bool)
    known[3::8, 5::10] = known[64:72, 80:90] = False
    light = field_of(np.where(known, 1 + values, 9.0), known, Sites(("",)))
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
    the line of least relative squares, and their mean. A bend is the mean deviation
    from a line through zero: a fifth of 4 times 0.2 % and 0.8 %."""
    times = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    levels = 1000 * times * np.array([1, 1, 1.01, 1, 1])
    line = np.polynomial.Polynomial.fit(times, levels, 1, w=1 / levels)
    expected = 100 * (levels / line(times) - 1)
    found = linearity(points(levels, times), 6000.0, 1e-3, 6000.0)
    np.testing.assert_allclose(found.deviations, expected, atol=1e-6)
    assert found.deviations[2] == pytest.approx(0.8, abs=0.1)
    assert found.error.value == pytest.approx(np.abs(expected).mean())
    assert found.bend == pytest.approx(0.0032, rel=0.01)


def test_a_loss_at_white_is_within_its_error_where_lamps_drift_more_than_told():
    """Three times more: levels' own deviations from the curve widen the error."""
    x, white, away = np.linspace(0.1, 0.9, 12), 6000.0, []
    for seed in range(150):
        drift = np.random.default_rng(seed).normal(0, 0.003 / math.sqrt(2), len(x))
        levels = white * x * (1 - 0.05 * x) * (1 + drift)
        loss = linearity(points(levels, x), white, 1e-3, white).quadratic
        away.append((loss.value - 0.05) / loss.standard_error)
    assert np.std(away) == pytest.approx(1.12, rel=0.2)  # Student's t of 10 freedoms
    assert abs(np.mean(away)) < 0.4


@pytest.mark.parametrize(("quadratic", "cubic"), [(0.06, 0.02), (0.03, None)])
def test_losses_at_white_are_those_of_the_planted_curve(quadratic, cubic):
    """x (1 - q x - c x^2) of 12,000 DN, by levels of 5 to 95 % of 6000 DN alone."""
    white, x = 12_000.0, np.array([0.001, 0.05, 0.1, 0.2, 0.3, 0.4, 0.45, 0.6])
    levels = white * x * (1 - quadratic * x - (cubic or 0) * x**2)
    levels[[0, -1]] *= 0.9
    made = points(levels, 10 * x)
    off = replace(made[3], level=0.9 * made[3].level)  # none of light alone
    made += [replace(off, clipped=0.5), replace(off, is_coarse=True)]
    found = linearity(made, 6000.0, 1e-6, white)
    assert found.levels == pytest.approx(levels[1:-1])
    assert found.quadratic.value == pytest.approx(quadratic, rel=1e-3)
    assert cubic is None or found.cubic.value == pytest.approx(cubic, rel=1e-3)
    assert (found.cubic is None) == (cubic is None)
    two, three = (linearity(made[1:end], 6000.0, 1e-6, white) for end in (3, 4))
    assert two is None and three is not None


def test_a_lamps_drift_is_the_deviation_of_repeats_from_their_means():
    """1 % in four of five flats, three of which are free; an error by chi-square."""
    groups = [[99.0, 101.0], [198.0, 200.0, 202.0], [7.0]]
    found = lamp_drift([np.array(one) for one in groups])
    assert found.value == pytest.approx(0.01 * math.sqrt(4 / 3))
    assert found.standard_error == pytest.approx(found.value / math.sqrt(6))
    assert lamp_drift([np.array([7.0])]) is None


@pytest.mark.parametrize(("time", "charge"), [(2.0, 10.0), (None, 0.0)])
def test_flats_are_above_the_black_level_that_is_known_and_the_charge_of_darks(
    time, charge
):
    """Of 5 DN/s, and a level that lies 3 DN above that by which they were read."""
    line = DarkCurrent(((None, Measured(5.0, 0.1, "DN/s")),), None, ())
    full = Measured(3000.0, 2.0, "DN")
    transfer = PhotonTransfer(points([1000.0], [time]), full, FULL_WELL, [], 4)
    seen = SimpleNamespace(sensor=SimpleNamespace(white_level=4095))
    levels = np.array([256.0]), np.array([259.0])
    found = above_darks(seen, transfer, DarkResults(dark=line), *levels)
    [point] = found.transfer.points
    assert point.level == 1000 - 3 - charge
    assert point.mean.tolist() == [[1000 - 3 - charge]]
    assert found.transfer.saturation == Measured(2997.0, 2.0, "DN")
    assert (found.transfer.clipped, found.light, found.lamp) == (4, None, None)
    none = above_darks(seen, PhotonTransfer(clipped=6), DarkResults(), *levels)
    assert none.transfer == PhotonTransfer(clipped=6)
