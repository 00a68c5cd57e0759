# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""profile_syntax.h: texts that are no profile are refused before they cost anything."""

import json
import math

import pytest

import cg2raw
from oracles import cameras


def error_of(text):
    """Return the message with which text is refused; text : str or bytes."""
    with pytest.raises(ValueError) as refused:
        cg2raw.Sensor.from_json(text, "inline.json")
    message = str(refused.value)
    assert message.startswith("inline.json: ")
    assert len(message) < 400  # one line, however long the text
    assert message.isprintable()
    return message


def nested(depth):
    return "[" * depth + "]" * depth


def with_evidence(text):
    """Return a profile's text with JSON text as the evidence of an effect."""
    effects = [{"name": "row_noise", "parameters": {}, "evidence": "@"}]
    return cameras.profile_text(effects=effects).replace('"@"', text)


def test_lists_in_lists_have_a_bound_so_that_no_stack_overflows():
    # The profile, its effects and the effect itself hold the evidence: 3 of 32.
    cg2raw.Sensor.from_json(with_evidence(nested(29)), "inline.json")
    for depth in (30, 500_000):
        assert "more than 32 lists and objects" in error_of(
            with_evidence(nested(depth))
        )
    width = cameras.profile_text().replace('"width": 64', '"width": ' + nested(500_000))
    assert "more than 32 lists and objects" in error_of(width)
    assert "more than 32 lists and objects" in error_of("[" * 500_000)
    assert "more than 32 lists and objects" in error_of('{"a":' * 500_000)


@pytest.mark.parametrize("field", ["bits", "sources", "noise", "noi\\u0073e"])
def test_a_field_given_twice_is_an_error(field):
    text = cameras.profile_text()
    twice = text[:-1] + f', "{field}": {json.dumps(cameras.profile()["bits"])}}}'
    name = json.loads(f'"{field}"')
    assert f"{name} is there twice" in error_of(twice)


def test_a_field_given_twice_inside_an_object_is_an_error():
    text = cameras.profile_text().replace('{"iso": 100', '{"iso": 50, "iso": 100')
    assert "iso is there twice" in error_of(text)


def test_the_same_field_in_two_objects_is_none():
    cg2raw.Sensor.from_json(cameras.profile_text(), "inline.json")  # two rows of noise


def test_an_object_has_up_to_1000_fields():
    sources = {f"field {i}": "planted" for i in range(1000)}
    cg2raw.Sensor.from_json(cameras.profile_text(sources=sources), "inline.json")
    sources["another"] = "planted"
    message = error_of(cameras.profile_text(sources=sources))
    assert "another is one field too many" in message


def test_values_have_a_bound():
    neutrals = [[0.5, 0.6]] * 83_000  # three values each
    text = cameras.profile_text(illuminants={"neutrals": neutrals})
    cg2raw.Sensor.from_json(text, "inline.json")
    text = cameras.profile_text(illuminants={"neutrals": neutrals + neutrals[:400]})
    assert "more than 250000 values" in error_of(text)


def test_bytes_have_a_bound_for_texts_as_for_files(tmp_path):
    text = cameras.profile_text() + " " * (16 << 20)
    assert "bytes are too many" in error_of(text)
    path = tmp_path / "large.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"large\.json: \d+ bytes are too many"):
        cg2raw.Sensor(str(path))


@pytest.mark.parametrize(
    "text",
    [
        '{"' + "a" * 1_000_000 + '": 1, ',  # ends too early, behind a long name
        '{"a": "' + "b" * 1_000_000,
        '{"a": "\u4e00\u4e00',
        '{"a": 1e999}',
        '{"a": "\\ud800"}',
        '{"a": 1}{',
        "\x01",
        "",
    ],
)
def test_what_is_no_json_is_said_in_one_short_line(text):
    assert "is no JSON" in error_of(text)


@pytest.mark.parametrize(
    "text",
    [
        json.dumps({str(i): 1 for i in range(500_000)}),
        json.dumps({"sources": {str(i): "a" for i in range(500_000)}}),
        "[" + "{}," * 2_000_000 + "{}]",
        "[" + "[]," * 2_000_000 + "[]]",
        '{"effects": [' + '{"name":"a"},' * 500_000 + "{}]}",
    ],
    ids=["fields", "sources", "objects", "lists", "effects"],
)
def test_millions_of_values_are_refused_at_once(text):
    assert error_of(text)  # where a quadratic reader would take minutes


def hull(corners, radius=0.1):
    turns = [2 * math.pi * i / corners for i in range(corners)]
    return [[0.5 + radius * math.cos(t), 0.6 + radius * math.sin(t)] for t in turns]


def lights(**changes):
    legal = {"mean": [0.5, 0.6], "hull": hull(9)}
    covariance = [[1e-3, 0], [0, 1e-3]]
    return cameras.profile_text(
        illuminants={**legal, "covariance": covariance, **changes}
    )


def test_a_hull_of_neutrals_is_bounded():
    cg2raw.Sensor.from_json(lights(), "inline.json")
    cg2raw.Sensor.from_json(lights(hull=hull(1000)), "inline.json")
    message = error_of(lights(hull=hull(1100)))
    assert "hull has 1100 corners; at most 1000" in message


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("mean", [1e308, 0.6]),
        ("mean", [0.5, 0.0]),
        ("hull", [[0.4, 0.5], [0.6, 0.5], [0.5, 1e200]]),
        ("hull", [[-0.4, 0.5], [0.6, 0.5], [0.5, 0.7]]),
    ],
)
def test_a_distribution_lies_where_neutrals_may(field, value):
    message = error_of(lights(**{field: value}))
    assert f"illuminants: {field}" in message
    assert "0.01 to 100" in message


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mean": [0.5, 0.71]}, "mean 0.5, 0.71 must lie in the hull"),
        ({"covariance": [[0.05, 0], [0, 1e-3]]}, "variance 0.05 must be at most 0.03"),
        ({"covariance": [[1e-3, 0], [0, 0.05]]}, "variance 0.05 must be at most 0.03"),
    ],
)
def test_mean_and_variance_are_of_neutrals_within_the_hull(changes, words):
    assert words in error_of(lights(**changes))
