# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Read noise correlation: its whitening, and that it is found and told from others."""

from dataclasses import replace

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.base import registered
from cg2raw.diagnose.effects.catalogue import every
from diagnose.planted import sensor_of, shot_by_registry
from tiers import slow

SENSOR = sensor_of()
NAME = "read_noise_correlation"
EFFECT = every()[NAME]


@pytest.mark.parametrize(("coefficient", "seed"), [(-0.07, 1), slow(0.25, 2)])
def test_it_is_found_in_what_the_registry_simulates(coefficient, seed):
    hidden = {NAME: {"coefficient": coefficient}}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    low, high = one.parameters["coefficient"].ci95
    assert low < coefficient < high and high - low < 0.04
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    assert low < entry["parameters"]["coefficient"] < high


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [("noise_reduction", {"blend": 0.05}), ("blur", {"ring_1": 0.05})],
)
def test_what_softens_is_not_taken_for_it(name, values):
    null = dict.fromkeys([p["name"] for p in registered()[name]["parameters"]], 0.0)
    captures = shot_by_registry(SENSOR, {name: {**null, **values}})
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == [name]


@pytest.mark.slow
def test_a_profile_that_lists_it_has_no_gap():
    values = {"coefficient": 0.2}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    known = sensor_of(effects=[{"name": NAME, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
