# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random telegraph noise: found, and told from tails and hot pixels."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.prediction import Prediction
from diagnose.planted import sensor_of, shot_by_registry

SENSOR = sensor_of()
NAME = "random_telegraph_noise"
EFFECT = every()[NAME]


def test_its_density_integrates_to_one():
    """Of pixels that jump by chance, by sure, and never."""
    shape, grid = (1, 1, 3), np.linspace(-60, 60, 24001)
    chance = np.array([0.01, 1.0, 0.0]).reshape(shape)
    sensor_map = SensorMap(chance * 25.0, np.zeros(shape), chance=chance)
    p = Prediction(*(np.ones(shape) for _ in range(4)))
    heights = []
    for value in grid:
        white, cost = EFFECT.whiten_by_map(np.full(shape, value), p, sensor_map)
        heights.append(np.exp(-0.5 * white**2 + cost) / np.sqrt(2 * np.pi))
    assert np.trapezoid(heights, grid, axis=0) == pytest.approx(1, abs=1e-3)
    white, _ = EFFECT.whiten_by_map(np.full(shape, 3.0), p, sensor_map)
    assert white.ravel()[1:] == pytest.approx([3 / np.sqrt(26), 3.0], abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fraction", "amplitude", "seed"), [(0.01, 0.006, 1), (0.003, 0.004, 2)]
)
def test_it_is_found_in_what_the_registry_simulates(fraction, amplitude, seed):
    """Steps of 10 and 7 read noises. Of the two darks that each split has, half the
    pixels show one state alone."""
    hidden = {NAME: {"fraction": fraction, "amplitude": amplitude}}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    for parameter, planted in hidden[NAME].items():
        low, high = one.parameters[parameter].ci95
        assert low < planted < high, parameter
    profile = Sensor.from_json(found.profile_json, "found").effects
    entries = {entry["name"]: entry["parameters"] for entry in profile}
    assert set(entries[NAME]) == set(hidden[NAME])
    # Those that showed one state alone in all fit frames are offsets to them.
    assert set(entries) <= {NAME, "dsnu"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("hot_pixels", {"fraction": 0.003, "rate": 0.005}),
        ("heavy_tailed_noise", {"outlier_fraction": 0.02}),
        ("dsnu", {"sigma": 4e-4}),
    ],
)
def test_what_looks_alike_is_not_taken_for_it(name, values):
    if name == "heavy_tailed_noise":
        profile = json.loads(SENSOR.to_json())
        shape = {"tukey_lambda": 0.14, "row_sigma": 0.0, **values}
        profile["noise"][0] |= {"outlier_variance_ratio": 16.0, **shape}
        profile["noise_effects"] = ["shot_noise", name]
        heavy = Sensor.from_json(json.dumps(profile), "heavy")
        captures = replace(shot_by_registry(heavy, {}), sensor=SENSOR)
    else:
        captures = shot_by_registry(SENSOR, {name: values})
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == [name]


@pytest.mark.slow
def test_a_profile_that_lists_it_has_no_gap():
    values = {"fraction": 0.005, "amplitude": 0.005}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    known = sensor_of(effects=[{"name": NAME, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
