# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""verdict.json has the published fields, and is a Diagnosis again."""

import dataclasses
import json
import math

import pytest

from cg2raw.diagnose.report.verdict_json import DRAWN, read_verdict, verdict_json
from diagnose.diagnoses import diagnosis, finding


def test_the_published_fields_are_there_first():
    fields = json.loads(verdict_json(diagnosis()))
    assert list(fields)[:5] == ["verdict", "effects", "gap", "unexplained", "seconds"]
    assert fields["verdict"] == "explained" and fields["seconds"] == 12.3
    [effect] = fields["effects"]
    assert effect["name"] == "lens_shading"
    r2 = {"value": -0.31, "unit": "1", "ci95": [-0.32, -0.3]}
    assert effect["parameters"]["r2"] == r2
    assert (effect["gain_nats"], effect["e_value"]) == (18342.1, 1e300)
    [other] = effect["alternatives"]
    assert (other["name"], other["gain_nats"]) == ("veiling_glare", 212.0)
    assert effect["where"].startswith("falls off")
    gap = fields["gap"]
    assert (gap["before"], gap["unit"]) == (0.41, "nats/pixel")
    assert gap["after"] == pytest.approx(0.0003)
    assert (gap["chi2_before"], gap["chi2_after"]) == (3.2, 1.001)
    assert gap["held_out"] == ["shot_7.dng"]
    [left] = fields["unexplained"]
    assert (left["test"], left["statistic"]) == ("row autocorrelation", 4.1)
    assert left["where"] == "rows, all channels" and "name" not in left
    assert not set(DRAWN) & set(fields)


def test_what_json_cannot_hold_is_null():
    text = verdict_json(diagnosis())
    assert "Infinity" not in text and "NaN" not in text
    tilt = json.loads(text)["effects"][0]["parameters"]["tilt_x"]
    assert tilt == {"value": 0.0, "unit": "1", "ci95": [None, None]}


def test_it_is_a_diagnosis_again():
    first = diagnosis(interrupted=True)
    again = read_verdict(verdict_json(first))
    for field in dataclasses.fields(first):
        if field.name in (*DRAWN, "effects", "gap"):
            continue
        assert getattr(again, field.name) == getattr(first, field.name), field.name
    assert again.gap.held_out == ["shot_7.dng"]
    effect = again.effects[0]
    assert effect.parameters["r2"] == finding().parameters["r2"]
    assert math.isnan(effect.parameters["tilt_x"].ci95[0])
    assert effect.alternatives == finding().alternatives
    assert verdict_json(again) == verdict_json(first)


def test_the_same_diagnosis_has_the_same_bytes():
    assert verdict_json(diagnosis()) == verdict_json(diagnosis())


def changed(**changes):
    """Return the text of verdict.json with fields changed; None drops one."""
    fields = {**json.loads(verdict_json(diagnosis())), **changes}
    return json.dumps(
        {key: value for key, value in fields.items() if value is not None}
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "verdict.json: is no JSON"),
        ("[1]", "is no verdict"),
        (changed(verdict="perhaps"), "must be one of consistent, explained, ambiguous"),
        (changed(gap=None), "verdict.json: has no gap"),
        (changed(gap=[1]), "gap: is [1]; must be an object"),
        (changed(effects=[{}]), "effects[0]: has no name"),
        (changed(sensor_id=3), "sensor_id: is 3; must be str"),
    ],
)
def test_what_is_no_verdict(text, words):
    with pytest.raises(ValueError) as error:
        read_verdict(text)
    assert words in str(error.value)
