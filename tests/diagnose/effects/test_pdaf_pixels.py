# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""PDAF pixels: the grid is found, its gain fitted, no other pattern taken for it."""

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from diagnose.planted import (
    sensor_of,
    shot_by_registry,
)
from tiers import slow

SENSOR = sensor_of()
NAME = "pdaf_pixels"


@pytest.mark.parametrize(
    ("grid", "seed"), [((-0.1, 12, 5, 3), 1), slow((0.02, 9, 0, 8), 2)]
)
def test_it_is_found_in_what_the_registry_simulates(grid, seed):
    hidden = {NAME: dict(zip(("gain", "pitch", "row", "column"), grid, strict=True))}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    low, high = one.parameters["gain"].ci95
    assert low < grid[0] < high and high - low < 0.01
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    for name, value in list(hidden[NAME].items())[1:]:
        assert entry["parameters"][name] == value
        assert one.parameters[name].ci95 == (value, value), "found once, and exact"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("prnu", {"sigma": 0.01}),
        ("gr_gb_imbalance", {"gr": 0.01, "gb": -0.01}),
        ("hot_pixels", {"fraction": 0.003, "rate": 0.02}),
    ],
)
def test_what_looks_alike_is_not_taken_for_it(name, values):
    captures = shot_by_registry(SENSOR, {name: values})
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == [name]
