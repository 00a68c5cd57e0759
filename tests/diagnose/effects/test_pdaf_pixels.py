# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""PDAF pixels: the grid is found, its gain fitted, no other pattern taken for it."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    capture_of,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    shot_by_registry,
)
from tiers import slow

SENSOR = sensor_of()
NAME = "pdaf_pixels"
EFFECT = every()[NAME]


@pytest.mark.parametrize(
    "grid", [(-0.1, 4, 1, 3), (0.05, 11, 10, 0), (-0.2, 16, 0, 15), (-0.3, 24, 7, 9)]
)
def test_a_grid_is_found(grid):
    frames = frames_of(SENSOR, captures_of(("flat", "flat", "scene", "dark")))
    shown = on(drawn(frames, model_of(SENSOR, pdaf_pixels=grid), 3))
    gain, *places = EFFECT.first_values(shown.predicted(Model(SENSOR)))
    assert tuple(places) == grid[1:]
    assert gain == pytest.approx(grid[0], abs=0.03)


def test_a_grid_is_found_on_tiles_of_a_large_frame():
    capture = capture_of("flat", shape=(600, 900), level=0.6)
    frames = frames_of(SENSOR, [capture], pixels=40000)
    assert len(frames[0].tiles.origins) > 1
    grid = (-0.15, 22, 13, 18)
    shown = on(drawn(frames, model_of(SENSOR, pdaf_pixels=grid), 4))
    found = EFFECT.first_values(shown.predicted(Model(SENSOR)))
    assert tuple(found[1:]) == grid[1:]


def test_darks_show_no_grid():
    shown = on(frames_of(SENSOR, captures_of(("dark", "dark"))))
    assert EFFECT.first_values(shown.predicted(Model(SENSOR))) is None


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


@pytest.mark.slow
def test_what_a_profile_lists_is_corrected_on_the_grid_that_is_found():
    values = {"gain": -0.1, "pitch": 12.0, "row": 5.0, "column": 3.0}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    doubted = {**values, "gain": -0.06}
    known = sensor_of(effects=[{"name": NAME, "parameters": doubted}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert [one.name for one in found.effects] == [NAME]
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    assert entry["parameters"] == pytest.approx({**values, "gain": -0.1}, abs=0.004)


def test_its_parameters_come_together():
    """A profile's gain and the one found on top of it are on one grid."""
    both = EFFECT.added(np.array([-0.1, 12, 5, 3]), np.array([0.02, 12, 5, 3]))
    assert both == pytest.approx([-0.08, 12, 5, 3])
