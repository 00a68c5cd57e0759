# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The slope of darks over exposure time, and its noise; of frames:
test_frame_statistics.py."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.statistics.dark_rates import slope_of

FRAMES, TIMES = np.array([4, 1, 3, 2]), np.array([0.0, 5.0, 20.0, 8.0])
IS_FLAT = np.array([False, False, False, True])
POWER = np.array([9.0, np.nan, 12.0, 99.0])  # DN^2, of a frame; one has no pair


def statistics(splits=("", "", "", ""), times=TIMES, pairs=FRAMES // 2):
    """Return three groups of darks, and flats."""
    return SimpleNamespace(
        is_flat=IS_FLAT,
        splits=np.array(splits),
        groups=[SimpleNamespace(charge_time=time) for time in times],
        pairs=pairs,
        frames=FRAMES,
        planes=[SimpleNamespace(power=n * POWER) for n in (1.0, 4.0)],
    )


def test_the_slope_is_that_of_least_squares_of_all_frames():
    """A single frame's noise is the usual one; charge has a variance by its time."""
    found = slope_of(statistics(), "")
    assert found.weights @ (7 + 3 * TIMES) == pytest.approx(3)
    darks = FRAMES[:3]
    level = np.random.default_rng(1).normal(size=4)
    expected, _ = np.polyfit(TIMES[:3], level[:3], 1, w=np.sqrt(darks))
    assert found.weights @ level == pytest.approx(expected)
    squares = found.weights[:3] ** 2 / darks
    noise = np.sqrt(squares @ [9.0, 10.5, 12.0])
    assert found.noise == pytest.approx([noise, 2 * noise])
    assert found.charge == pytest.approx(squares @ TIMES[:3])


@pytest.mark.parametrize(
    "given",
    [
        {"times": np.full(4, 3.0)},
        {"pairs": np.array([0, 0, 0, 1])},
        {"splits": ("", "a", "a", "")},  # one time of its own
    ],
)
def test_darks_of_one_time_or_without_repeats_have_no_slope(given):
    assert slope_of(statistics(**given), "") is None
