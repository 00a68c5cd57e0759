# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shapes that a profile states are taken off frames that have them."""

import numpy as np
import pytest

from cg2raw.diagnose.stated_shapes import StatedShapes
from cg2raw.model.evaluation import Parameters
from cg2raw.statistics.constant import PIXEL, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from diagnose.planted import sensor_of, stating

SHAPE, FRAMES = (64, 96), 4
BLACK, LIGHT, NOISE = 300.0, 5000.0, 3.0  # DN
RATE, RAMP = 50.0, 60.0  # DN/s of dark current; DN from the left edge to the right one
FALL = {"r2": -0.4, "r4": 0.3}  # of light, by powers of the radius
DARKS_AND_FLATS = ("dark", 1.0, 0.0), ("dark", 9.0, 0.0), ("flat", 9.0, LIGHT)
PLAIN = sensor_of(black_level=[BLACK] * 4)
RADIUS = np.hypot(*np.meshgrid(*(np.arange(n) + 0.5 - n / 2 for n in SHAPE[::-1])))
SQUARE = (RADIUS / (np.hypot(*SHAPE) / 2)) ** 2
SHADING = 1 + FALL["r2"] * SQUARE + FALL["r4"] * SQUARE**2
OFFSET = RAMP * ((np.arange(SHAPE[1]) + 0.5) / SHAPE[1] - 0.5) * np.ones(SHAPE)


def statistics_of(offset, shading):
    """Return those of darks of two times, and of flats, with an offset, DN, and a
    shading of light."""
    rng, groups = np.random.default_rng(1), []
    for kind, seconds, light in DARKS_AND_FLATS:
        mean = BLACK + offset + RATE * seconds + light * shading
        frames = mean + NOISE * rng.standard_normal((FRAMES, *SHAPE))
        names = tuple(f"{kind}-{n}" for n in range(FRAMES))
        codes = np.rint(frames).astype(np.uint16)
        info = GroupInfo(kind, names, seconds)
        groups.append((info, [lambda c=c: c for c in codes]))
    return frame_statistics(groups, 2, PLAIN.white_level)


def test_frames_lack_the_shapes_that_their_profile_states():
    """What lines and patches have is within five errors of the mean of so many samples;
    levels and single pixels stay."""
    ramp = {"horizontal": RAMP / PLAIN.signal_range}
    sensor = stating(PLAIN, {"bias_structure": ramp, "lens_shading": FALL})
    statistics, parameters = statistics_of(OFFSET, SHADING), Parameters(4)
    stated = StatedShapes.of(sensor, statistics)
    assert set(stated.names) == {"bias_structure", "lens_shading"}
    sites = [(r, c) for r in range(2) for c in range(2)]
    means = [SHADING[r::2, c::2].mean() for r, c in sites]
    assert stated.mean == pytest.approx(means, rel=1e-4)
    profile = np.zeros(len(parameters.names))
    profile[parameters.each("black_level")] = BLACK
    with_means = stated.added_to(profile, parameters)
    above = [OFFSET[r::2, c::2].mean() for r, c in sites]
    levels = with_means[parameters.each("black_level")]
    assert levels == pytest.approx(BLACK + np.array(above), abs=1e-3)
    clean = stated.without(statistics, with_means)
    h, w = np.array(SHAPE) // 2
    for before, plane in zip(statistics.planes, clean.planes, strict=True):
        assert np.array_equal(plane.level, before.level)
        most = 5 * NOISE / np.sqrt(FRAMES)
        assert np.abs(plane.rows).max() < most / np.sqrt(w) < np.ptp(before.rows[2])
        assert (
            np.abs(plane.columns).max() < most / np.sqrt(h) < np.ptp(before.columns[0])
        )
        assert np.abs(plane.field).max() < most < np.abs(before.field[2]).max()
        assert plane.products[PIXEL] == pytest.approx(before.products[PIXEL], rel=1e-6)


def test_a_profile_without_shapes_changes_nothing():
    statistics, parameters = statistics_of(0.0, 1.0), Parameters(4)
    stated = StatedShapes.of(stating(PLAIN, {"prnu": {"sigma": 0.01}}), statistics)
    profile = np.arange(float(len(parameters.names)))
    assert (stated.names, stated.mean) == ((), [1.0])
    assert np.array_equal(stated.added_to(profile, parameters), profile)
    assert stated.without(statistics, profile) is statistics
    assert stated.allowed(statistics) == {}


@pytest.mark.parametrize("ramp", [RAMP, 3 * RAMP])
def test_frames_may_have_a_hundredth_of_a_shape_s_squares_beyond_it(ramp):
    """Of a ramp, all squares are of three polynomials across, which sites shift a
    little; colours that fall off alike have no shape of their own."""
    stated = {
        "bias_structure": {"horizontal": ramp / PLAIN.signal_range},
        "color_shading": {"red_r2": 0.0},
    }
    statistics = statistics_of(OFFSET, SHADING)
    allowed = StatedShapes.of(stating(PLAIN, stated), statistics).allowed(statistics)
    squares = SHAPE[0] * SHAPE[1] / 4 * ramp**2 / 12
    assert allowed["bias_structure"] == pytest.approx(0.01 * squares / 3, rel=0.05)
    assert allowed["color_shading"] == pytest.approx(0, abs=1e-6)
