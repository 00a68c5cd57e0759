# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""verdict.json has the published fields."""

import json
from dataclasses import fields, replace

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import Estimate, Gap
from cg2raw.diagnose.report.verdict_json import DRAWN, verdict_json
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
    known = {field.name for field in fields(diagnosis())}
    assert {*written} == known - {*DRAWN} | {"files"}


def test_what_json_cannot_hold_is_null():
    text = verdict_json(diagnosis())
    assert "Infinity" not in text and "NaN" not in text
    odd = json.loads(text)["effects"][0]["parameters"]["r2"]
    assert odd == {"value": 0.0, "unit": "1", "ci95": [None, None]}
