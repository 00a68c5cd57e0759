# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Mains flicker: found with its period, and told from noise that rows have in darks."""

from dataclasses import replace

import pytest

from cg2raw.diagnose import diagnose
from diagnose.planted import (
    sensor_of,
    shot_by_registry,
)
from tiers import slow

SENSOR = sensor_of()
NAME = "mains_flicker"


@pytest.mark.parametrize(
    ("amplitude", "period", "seed"), [(0.02, 37.0, 1), slow(0.005, 60.0, 2)]
)
def test_it_is_found_in_what_the_registry_simulates(amplitude, period, seed):
    hidden = {NAME: {"amplitude": amplitude, "period": period}}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == [NAME]


@pytest.mark.slow
def test_row_noise_is_not_taken_for_it():
    captures = shot_by_registry(SENSOR, {"row_noise": {"sigma": 3e-4}})
    found = diagnose(captures, threads=1, details=False)
    assert [one.name for one in found.effects] == ["row_noise"]


@pytest.mark.slow
def test_a_profile_that_lists_it_has_no_gap():
    values = {"amplitude": 0.03, "period": 25.0}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    known = sensor_of(effects=[{"name": NAME, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
