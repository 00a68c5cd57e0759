# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Fixed patterns that are not as strong as a profile says are findings."""

import json
from dataclasses import replace

import pytest

from calibration.planted import RANGE, frames_of, sensor_of
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.refinement import capture_of

TRUTH = {
    "dsnu": {"sigma": 2 / RANGE},
    "column_fixed_pattern": {"sigma": 0.5 / RANGE},
    "dark_current": {"per_second": 0.5 / RANGE},
    "dark_current_nonuniformity": {"rate": 0.4 / RANGE, "log_sigma": 0.5},
    "hot_pixels": {"fraction": 0.01, "rate": 4 / RANGE},
    "prnu": {"sigma": 0.01},
}
SHAPE = (96, 128)


def diagnosed(**said):
    """Return the diagnosis of frames by a profile that says something else of some
    effects."""
    camera = sensor_of(TRUTH, shape=SHAPE)
    frames = frames_of(camera, biases=6, darks=6, flats=6)
    turns = {"dark": 0, "flat": 0}
    captures = []
    for frame in frames:
        group = GROUPS[turns[frame.kind] % 3]
        turns[frame.kind] += 1
        captures.append(replace(capture_of(frame, SHAPE), group=group))
    sensor = sensor_of(TRUTH | said, shape=SHAPE)
    return diagnose(CaptureSet(sensor, captures), details=False)


def test_a_profile_that_is_right_is_not_contradicted():
    assert diagnosed().verdict == "no gap"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("prnu", {"sigma": 0.006}),
        ("dsnu", {"sigma": 3.5 / RANGE}),
        ("column_fixed_pattern", {"sigma": 0.1 / RANGE}),
        ("hot_pixels", {"fraction": 0.002, "rate": 4 / RANGE}),
        ("dark_current_nonuniformity", {"rate": 0.15 / RANGE, "log_sigma": 0.5}),
    ],
)
def test_the_one_that_a_profile_says_wrongly_is_named_alone(name, said):
    found = diagnosed(**{name: said})
    assert [effect.name for effect in found.effects] == [name]
    assert found.verdict == "identified"
    profile = json.loads(found.profile_json)
    written = next(e for e in profile["effects"] if e["name"] == name)["parameters"]
    for parameter, truth in TRUTH[name].items():
        assert written[parameter] == pytest.approx(truth, rel=0.2), parameter
    assert [rung.action for rung in found.ladder] == ["contradicted"]
    assert found.gap.after < found.gap.before
