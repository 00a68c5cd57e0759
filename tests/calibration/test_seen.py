# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which darks are measured together."""

from types import SimpleNamespace

from cg2raw.calibration.seen import splits_of


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
