# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Mains flicker: found with its period, and told from noise that rows have in darks."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    captures_of,
    drawn,
    frames_of,
    on,
    sensor_of,
    shot_by_registry,
)
from tiers import slow

SENSOR = sensor_of()
NAME = "mains_flicker"
EFFECT = every()[NAME]


def waved(amplitude, period):
    """Return what adds a wave to a frame's light, of any phase."""

    def add(frame, rng):
        turns = frame.tiles.rows_and_columns()[0] / period + rng.random()
        light = frame.of_site(frame.camera.astype(float))
        return amplitude * light * np.cos(2 * np.pi * turns)

    return add


@pytest.mark.parametrize("period", [7.3, 23.0, 38.0])
def test_a_search_starts_at_the_period(period):
    """Of frames of 64 rows a period is known to about a tenth of a wave."""
    frames = frames_of(SENSOR, captures_of(("flat", "scene", "scene", "dark")))
    shown = on(drawn(frames, Model(SENSOR), 3, extra=waved(0.03, period)))
    amplitude, found = EFFECT.first_values(shown.predicted(Model(SENSOR)))
    assert found == pytest.approx(period, rel=0.1 * period / 64)
    assert amplitude == pytest.approx(0.03, rel=0.25)


def test_darks_show_no_wave():
    shown = on(frames_of(SENSOR, captures_of(("dark", "dark"))))
    assert EFFECT.first_values(shown.predicted(Model(SENSOR))) is None


@pytest.mark.parametrize(
    ("amplitude", "period", "seed"), [(0.02, 37.0, 1), slow(0.005, 60.0, 2)]
)
def test_it_is_found_in_what_the_registry_simulates(amplitude, period, seed):
    hidden = {NAME: {"amplitude": amplitude, "period": period}}
    captures = shot_by_registry(SENSOR, hidden, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    for parameter, planted in hidden[NAME].items():
        low, high = one.parameters[parameter].ci95
        assert low < planted < high, parameter
    assert one.parameters["period"].value == pytest.approx(period, rel=0.03)
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    assert entry["parameters"] == {
        name: value.value for name, value in one.parameters.items()
    }


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


def test_a_wave_that_all_frames_share_is_none():
    """What stays where it is is shading that no polynomial describes, or dust."""

    def still(frame, _):
        rows = frame.tiles.rows_and_columns()[0]
        light = frame.of_site(frame.camera.astype(float))
        return 0.03 * light * np.cos(2 * np.pi * rows / 23.0)

    frames = frames_of(SENSOR, captures_of(("flat", "flat", "scene", "dark")))
    shown = on(drawn(frames, Model(SENSOR), 3, extra=still))
    assert EFFECT.first_values(shown.predicted(Model(SENSOR))) is None


def test_noise_shows_no_wave():
    frames = frames_of(SENSOR, captures_of(("flat", "flat", "flat", "dark")))
    for seed in range(5):
        shown = on(drawn(frames, Model(SENSOR), seed))
        assert EFFECT.first_values(shown.predicted(Model(SENSOR))) is None
