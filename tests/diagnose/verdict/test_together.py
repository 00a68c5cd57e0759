# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One diagnosis of what darks and flats decide and what images do beside it."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import DetectionLimit, Gap, ResidualTest
from cg2raw.diagnose.verdict.findings import finding_of
from cg2raw.diagnose.verdict.together import together, with_images_alone
from diagnose.made_up_diagnosis import made_up_diagnosis
from diagnose.planted import capture_of, changed, sensor_of

SENSOR = sensor_of()
GAPS = Gap(0.4, 0.1, 1.8, 1.2, ["a", "b", "c"]), Gap(0.8, 0.5, 2.6, 2.0, ["d"])
LEFT = ResidualTest("rows", 4.1, 2e-5, 2.3e-4, "odd rows")


def named(*names, ambiguous_with=()):
    return [finding_of(name, {}, 20.0, SENSOR, False, ambiguous_with) for name in names]


def both(first=(), second=(), left=(), verdict="explained"):
    """Return the diagnosis of darks and flats and of images that name effects."""
    limits = [
        [DetectionLimit(*one, "1") for one in each]
        for each in (
            [
                ("prnu", "sigma", 0.1),
                ("exposure", "gain", 0.2),
                ("blur", "ring_1", 0.3),
            ],
            [("exposure", "gain", 0.4), ("read_noise", "log_variance", 0.5)],
        )
    ]
    return together(
        made_up_diagnosis(
            sensor_id="camera",
            effects=list(first),
            gap=GAPS[0],
            unexplained=list(left),
            detection_limits=limits[0],
            notes=["both", "first"],
            profile_json="first",
            groups={"fit": ["x"], "report": ["a", "b", "c"]},
        ),
        made_up_diagnosis(
            sensor_id="camera as decided",
            verdict=verdict,
            effects=list(second),
            gap=GAPS[1],
            unexplained=[],
            detection_limits=limits[1],
            notes=["both", "second"],
            profile_json="",
            groups={"fit": ["x", "y"], "report": ["d"]},
        ),
    )


def test_what_both_say_is_there_once_and_each_frame_counts_alike():
    found = both(named("row_noise"), named("blur"))
    assert [one.name for one in found.effects] == ["row_noise", "blur"]
    assert found.notes == ["both", "first", "second"]
    assert found.groups == {"fit": ["x", "y"], "report": ["a", "b", "c", "d"]}
    assert (found.sensor_id, found.profile_json) == ("camera", "first")
    gap = found.gap
    numbers = gap.before, gap.after, gap.chi2_before, gap.chi2_after
    assert numbers == pytest.approx((0.5, 0.2, 2.0, 1.4))
    assert gap.held_out == ["a", "b", "c", "d"]


def test_a_limit_is_that_of_the_frames_which_show_the_effect():
    """Of what is not named: light is of images, the rest of darks, if they show it."""
    limits = {
        one.name: one.strength for one in both(named("read_noise")).detection_limits
    }
    assert limits == {"prnu": 0.1, "exposure": 0.4}


@pytest.mark.parametrize(
    ("given", "verdict"),
    [
        ({}, "consistent"),
        ({"first": named("prnu")}, "explained"),
        ({"second": named("blur", ambiguous_with=["exposure"])}, "ambiguous"),
        ({"left": [LEFT]}, "unexplained"),
        ({"left": [LEFT], "second": named("blur")}, "partially_explained"),
        ({"verdict": "incomplete", "first": named("prnu")}, "incomplete"),
    ],
)
def test_the_verdict_is_on_all_that_was_found(given, verdict):
    found = both(**given)
    assert found.verdict == verdict
    assert found.unexplained == given.get("left", [])
    assert {one.provisional for one in found.effects} <= {"left" in given}


def test_what_softens_images_may_be_a_filter_that_darks_may_have():
    noise = named("read_noise", ambiguous_with=["noise_reduction"])
    found = both(noise, named("blur", "exposure"))
    alike = {one.name: list(one.ambiguous_with) for one in found.effects}
    assert alike["blur"] == ["noise_reduction"] and alike["exposure"] == []


def test_images_are_seen_without_pixels_of_patterns_by_the_profile_so_far():
    shape, other = (64, 96), (32, 96)
    captures = [
        capture_of("dark", 1),
        capture_of("flat", 2),
        capture_of("scene", 3, mask=lambda: np.arange(96) % 2 + np.zeros(shape) > 0),
        capture_of("scene", 4, shape=other),
    ]
    masked = np.zeros(shape, bool)
    masked[5] = True
    decided = made_up_diagnosis(
        profile_json=changed(SENSOR, white_level=9999).to_json()
    )
    given = CaptureSet(SENSOR, captures)
    found = with_images_alone(given, decided, masked, used=captures[:2])
    assert [one.name for one in found.captures] == ["flat-2", "scene-3", "scene-4"]
    assert found.sensor.white_level == 9999
    flat, scene, small = found.captures
    assert (flat.mask() == ~masked).all()
    assert (scene.mask() == (captures[2].mask() & ~masked)).all()
    assert small.mask is None
    unchanged = replace(decided, profile_json="")
    assert with_images_alone(given, unchanged, masked, []).sensor is SENSOR
    spare = with_images_alone(given, unchanged, masked, captures[1:2]).captures
    assert [one.name for one in spare][0] == "dark-1"
