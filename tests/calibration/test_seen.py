# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which darks are measured together."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.calibration.seen import Seen, splits_of
from cg2raw.calibration.sites import Sites


def group(kind, seconds, celsius, frames):
    return SimpleNamespace(
        kind=kind, exposure_time=seconds, temperature=celsius, frames=range(frames)
    )


def test_darks_of_another_set_point_are_alone():
    """That of most frames with charge, the shortest darks and flats are together."""
    groups = [
        group("dark", 0.0, -5.0, 10),
        group("dark", 60.0, -10.0, 3),
        group("dark", 60.0, -5.0, 4),
        group("dark", 120.0, -5.0, 2),
        group("flat", 1.0, -5.0, 8),
        group("flat", 2.0, -5.0, 8),
    ]
    assert splits_of(groups) == ["", "set point 0", "", "", "", ""]
    assert splits_of(groups[4:]) == ["", ""]


def test_the_mean_over_groups_is_that_of_all_of_their_frames():
    """Of four frames of 10 DN and two of 40 DN, without the group between."""
    statistics = SimpleNamespace(
        groups=range(3),
        frames=np.array([4, 9, 2]),
        mean_of=lambda number: np.full((2, 3), (10, 99, 40)[number], np.float32),
    )
    found = Seen(None, None, (), statistics).mean_over([0, 2])
    np.testing.assert_allclose(found, np.full((2, 3), 20))


def test_what_groups_show_is_said_of_the_site_that_shows_least():
    """Of two sites, and darks of no time, of 9 s and again of none, before flats."""
    times = (0.0, 9.0, 0.0, 1.0, 2.0)
    groups = [
        SimpleNamespace(kind="flat" if n > 2 else "dark", exposure_time=time)
        for n, time in enumerate(times)
    ]
    high = [np.array(each) for each in ([0, 0, 0, 0.3, 0.999], [0, 0, 0, 0.1, 0.99])]
    low = [np.array(each) for each in ([0, 0, 0, 0.0, 0], [0, 0, 0, 0.2, 0])]
    levels = [
        [(256.0, 258.0), (300.0,), (256.0,), (900.0, 902.0), (4095.0, 4095.0)]
    ] * 2
    planes = [
        SimpleNamespace(high=h, low=one, levels=tuple(map(np.array, some)))
        for h, one, some in zip(high, low, levels, strict=True)
    ]
    statistics = SimpleNamespace(
        groups=groups,
        planes=planes,
        frames=np.array([2, 1, 1, 2, 2]),
        variance=lambda number: np.array([0.3, (0.23, 0.25)[number]]),
    )
    seen = Seen(SimpleNamespace(white_level=4095), Sites(("",), 4), (), statistics)
    assert (seen.darks, seen.shortest) == ([0, 1, 2], [0, 2])
    assert seen.white == 4092  # whose code is the last one of 4 DN
    assert [seen.repeats(n) for n in range(5)] == [True, False, False, True, False]
    assert seen.clipped(3) == pytest.approx(0.3 + 0.2)
    assert seen.levels(3).tolist() == [900.0, 902.0]
    fine = Seen(None, Sites(("",)), (), statistics)
    assert [fine.is_coarse(n) for n in range(2)] == [True, False]  # 0.24 DN^2
