# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""verdict.json has the published fields, and is a Diagnosis again."""

import json
import math
from dataclasses import fields, replace

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import Estimate, Gap
from cg2raw.diagnose.report.verdict_json import DRAWN, read_verdict, verdict_json
from diagnose.made_up_diagnosis import WHITE, made_up_diagnosis

ODD = Estimate(np.float64(0.0), "1", (-np.inf, np.inf))


def diagnosis():
    """Return a diagnosis with numbers of NumPy, and some that are not finite."""
    found = made_up_diagnosis(gap=Gap(0.41, np.float32(3e-4), 3.2, 1.1, ["shot_7.dng"]))
    shading, rows = found.effects
    return replace(found, effects=[replace(shading, parameters={"r2": ODD}), rows])


def test_the_published_fields_are_there_first():
    written = json.loads(verdict_json(diagnosis()))
    assert list(written)[:5] == ["verdict", "effects", "gap", "unexplained", "seconds"]
    assert written["verdict"] == "explained" and written["seconds"] == 12.34
    _, effect = written["effects"]
    assert effect["name"] == "row_noise"
    sigma = {"value": 0.412 / WHITE, "ci95": [0.381 / WHITE, 0.447 / WHITE]}
    assert effect["parameters"]["sigma"] == {**sigma, "unit": "1"}
    assert (effect["gain_nats"], effect["e_value"]) == (31.7, 5.8e13)
    [other] = effect["alternatives"]
    assert (other["name"], other["gain_nats"]) == ("read_noise", 28.9)
    assert effect["where"].startswith("whole rows")
    gap = written["gap"]
    assert (gap["before"], gap["unit"]) == (0.41, "nats/pixel")
    assert gap["after"] == pytest.approx(0.0003)
    assert (gap["chi2_before"], gap["chi2_after"]) == (3.2, 1.1)
    assert gap["held_out"] == ["shot_7.dng"]
    [left] = written["unexplained"]
    assert (left["test"], left["statistic"]) == ("row autocorrelation", 4.1)
    assert left["where"] == "odd rows of the left half" and "name" not in left
    assert not set(DRAWN) & set(written)


def test_what_json_cannot_hold_is_null():
    text = verdict_json(diagnosis())
    assert "Infinity" not in text and "NaN" not in text
    odd = json.loads(text)["effects"][0]["parameters"]["r2"]
    assert odd == {"value": 0.0, "unit": "1", "ci95": [None, None]}


def test_it_is_a_diagnosis_again():
    first = replace(diagnosis(), interrupted=True)
    again = read_verdict(verdict_json(first))
    for field in fields(first):
        if field.name not in (*DRAWN, "effects", "gap"):
            assert getattr(again, field.name) == getattr(first, field.name), field.name
    assert again.gap.held_out == ["shot_7.dng"]
    odd, rows = again.effects
    assert math.isnan(odd.parameters["r2"].ci95[0])
    assert rows == first.effects[1]
    assert verdict_json(again) == verdict_json(first)


def test_the_same_diagnosis_has_the_same_bytes():
    assert verdict_json(diagnosis()) == verdict_json(diagnosis())


def changed(**changes):
    """Return the text of verdict.json with fields changed; None drops one."""
    changed = {**json.loads(verdict_json(diagnosis())), **changes}
    return json.dumps(
        {key: value for key, value in changed.items() if value is not None}
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
