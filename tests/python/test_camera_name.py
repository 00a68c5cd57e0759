# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A camera's make is said once."""

import pytest

from cg2raw._core import camera_name
from cg2raw.profile.spectral import profile_from_ssf
from python.spectra import SENSOR, three_lobes


@pytest.mark.parametrize(
    ("make", "model", "name"),
    [
        ("Canon", "Canon EOS 600D", "Canon EOS 600D"),
        ("NIKON CORPORATION", "NIKON D40", "NIKON D40"),
        ("OLYMPUS IMAGING CORP.", "E-PL6", "OLYMPUS E-PL6"),
        ("SAMSUNG", "samsung NX2000", "samsung NX2000"),
        ("Leica Camera AG", "Leica-Q", "Leica-Q"),
        ("Sony", "Sonyx", "Sony Sonyx"),  # whole words
        ("Sony", "Sony", "Sony"),
        ("A+B", "A+B 1", "A+B 1"),
        ("", "One", "One"),
        ("One", "", "One"),
    ],
)
def test_a_make_that_the_model_begins_with_is_said_once(make, model, name):
    assert camera_name(make, model) == name


def test_a_profile_of_sensitivities_has_that_name_and_id():
    names = {"make": "Canon", "model": "Canon EOS Test"}
    profile = profile_from_ssf(three_lobes(), **SENSOR, **names, lights=["A"])
    assert profile["unique_camera_model"] == "Canon EOS Test"
    assert profile["id"] == "canon-eos-test"
    assert (profile["make"], profile["model"]) == tuple(names.values())
