# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A profile's JSON as people read it: lists of numbers on a line, all else as it is."""

import json

import pytest

from cg2raw.io.json_text import checked, formatted
from dng import dng_files


@pytest.mark.parametrize(
    ("fields", "lines"),
    [
        ({"a": [1, -2.5, 1e-05]}, ["{", '  "a": [1, -2.5, 1e-05]', "}"]),
        ([[1, 2], [3]], ["[", "  [1, 2],", "  [3]", "]"]),
        (
            {"a": [], "b": ["x", 1]},
            ["{", '  "a": [],', '  "b": [', *2 * [""], "  ]", "}"],
        ),
        ({"a": "by [1,2], [3  4] and [e]\n[5 ]"}, ["{", "", "}"]),
    ],
)
def test_numbers_are_on_a_line_and_texts_stay(fields, lines):
    text = formatted(fields)
    assert json.loads(text) == fields
    found = text.splitlines()
    assert len(found) == len(lines) and text.endswith("\n")
    assert all(not line or line == one for line, one in zip(lines, found, strict=True))


def test_a_profile_is_what_it_was():
    fields = dng_files.fields_of("samsung-s20fe")
    fields["sources"]["cfa"] = "Smith et al. [3 4], table [1,2]"
    profile, text = checked(fields, "a.json")
    assert dict(profile.sources)["cfa"] == fields["sources"]["cfa"]
    assert json.loads(text)["sources"]["cfa"] == fields["sources"]["cfa"]
    fields["white_level"] = 10**6
    with pytest.raises(ValueError, match="a.json: white_level 1000000 must be 1 to"):
        checked(fields, "a.json")
