# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which darks are measured together."""

from types import SimpleNamespace

import numpy as np

from cg2raw.calibration.seen import Seen, splits_of


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
