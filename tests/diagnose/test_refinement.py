# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A calibration's fixed patterns, taken together by their likelihood."""

import json
from dataclasses import replace

import pytest

pytest.importorskip("scipy")

from calibration.planted import PATTERNS, frames_of, sensor_of
from cg2raw.calibration import calibrate
from cg2raw.diagnose import refine

CLOSE = {"log_sigma": 0.2, "rate": 0.15, "fraction": 0.15, "sigma": 0.1}  # relative


@pytest.fixture(scope="module")
def frames():
    return frames_of(sensor_of(PATTERNS), dark_times=(10.0, 30.0))


@pytest.fixture(scope="module")
def found(frames):
    return calibrate(sensor_of(), frames)


@pytest.fixture(scope="module")
def refined(found, frames):
    return refine(found, frames)


@pytest.mark.slow
def test_every_planted_pattern_is_as_strong_as_it_was_planted(refined):
    of_profile = {
        effect["name"]: effect["parameters"]
        for effect in json.loads(refined.updated_profile())["effects"]
    }
    for name in refined.likeliest:
        for parameter, value in of_profile[name].items():
            truth = PATTERNS[name][parameter]
            assert value == pytest.approx(truth, rel=CLOSE[parameter]), (
                f"{name} {parameter}"
            )
    assert set(refined.likeliest) == set(PATTERNS) - {"dark_current"}


@pytest.mark.slow
def test_its_intervals_are_in_the_profile(refined):
    effects = json.loads(refined.updated_profile())["effects"]
    prnu = next(one for one in effects if one["name"] == "prnu")
    low, high = prnu["ci95"]["sigma"]
    assert low < prnu["parameters"]["sigma"] < high < 1.1 * low


@pytest.mark.slow
def test_what_the_moments_measured_stays(found, refined):
    assert replace(refined, likeliest={}) == found


@pytest.mark.slow
def test_threads_change_nothing(found, frames, refined):
    assert refine(found, frames, threads=1).likeliest == refined.likeliest


def test_without_fixed_patterns_there_is_nothing_to_refine():
    frames = frames_of(sensor_of(), biases=3, darks=0, flats=3)
    plain = calibrate(sensor_of(), frames)
    assert refine(plain, frames) is plain


def test_biases_alone_refine_what_they_show():
    frames = frames_of(sensor_of(PATTERNS), darks=0, flats=0, dark_times=())
    found = refine(calibrate(sensor_of(), frames), frames)
    assert set(found.likeliest) == {"dsnu", "column_fixed_pattern"}
    sigma = found.likeliest["dsnu"]["sigma"].value
    assert sigma == pytest.approx(PATTERNS["dsnu"]["sigma"], rel=0.1)
