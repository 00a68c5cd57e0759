# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Options of an exposure that are of a wrong type: the message is about these alone."""

import dataclasses

import numpy as np
import pytest

import cg2raw
from cg2raw.exposure import TYPES

RGB = np.zeros((4, 4, 3), np.float32)
WRONG = {
    "iso": "100",
    "noise": 3,
    "seed": 1.5,
    "frame": 2**64,
    "digital_gain": "big",
    "convention": 3,
    "highlights": "no",
    "effects": "none",
    "camera_input": "yes",
    "as_shot": [1.0, 1.0],
    "exposure_time": [1],
    "color_effects": "no",
    "exposure": [1],
    "f_number": "2.8",
    "scene_luminance": "bright",
    "nd_filter": "3",
    "iso_limits": 100,
    "time_limits": [1.0],
    "f_number_limits": 2.8,
    "bracket": "2",
    "meter": "0.5",
}


def message_of(**run):
    """Return what is said of a run that is refused."""
    with pytest.raises(ValueError) as found:
        cg2raw.Sensor("nikon-d40").predict(RGB, illuminant="D65", **run)
    return str(found.value)


@pytest.mark.parametrize("name", WRONG)
def test_only_the_wrong_one_is_named(name):
    value = WRONG[name]
    assert message_of(**{name: value}) == f"{name} {value!r} must be {TYPES[name]}"


def test_two_wrong_ones_are_both_named():
    said = message_of(iso="100", effects="none")
    assert said == (
        "iso '100' must be a number or None; effects 'none' must be True or False"
    )


def test_every_field_of_a_run_has_words():
    fields = {field.name for field in dataclasses.fields(cg2raw.Run)}
    assert set(TYPES) == set(WRONG) == fields - {"illuminant"}
