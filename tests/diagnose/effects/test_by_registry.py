# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that the registry's simulation draws, alone: found with their values, and no
gap where the profile lists them. What looks alike: tests/diagnose/test_parts.py."""

from dataclasses import replace

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from diagnose.planted import sensor_of, shot_by_registry
from tiers import slow

SENSOR = sensor_of()
# How wide an interval may be. The grid of PDAF pixels is found once, and exact.
WIDEST = {"gain": 0.01, "coefficient": 0.04, "pitch": 0, "row": 0, "column": 0}
WIDEST |= {"amplitude": 0.02, "period": 8.0}


@pytest.mark.parametrize(
    ("name", "values", "seed"),
    [
        ("mains_flicker", {"amplitude": 0.02, "period": 37.0}, 1),
        slow("mains_flicker", {"amplitude": 0.005, "period": 60.0}, 2),
        ("pdaf_pixels", {"gain": -0.1, "pitch": 12, "row": 5, "column": 3}, 1),
        slow("pdaf_pixels", {"gain": 0.02, "pitch": 9, "row": 0, "column": 8}, 2),
        ("read_noise_correlation", {"coefficient": -0.07}, 1),
        slow("read_noise_correlation", {"coefficient": 0.25}, 2),
    ],
)
def test_it_is_found_with_its_values(name, values, seed):
    captures = shot_by_registry(SENSOR, {name: values}, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    [one] = found.effects
    assert one.name == name
    [entry] = Sensor.from_json(found.profile_json, "found").effects
    for parameter in values.keys() & WIDEST.keys():
        low, high = one.parameters[parameter].ci95
        assert low <= values[parameter] <= high <= low + WIDEST[parameter]
        assert low <= entry["parameters"][parameter] <= high


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mains_flicker", {"amplitude": 0.03, "period": 25.0}),
        ("read_noise_correlation", {"coefficient": 0.2}),
    ],
)
def test_a_profile_that_lists_it_has_no_gap(name, values):
    captures = shot_by_registry(SENSOR, {name: values}, 3)
    known = sensor_of(effects=[{"name": name, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
