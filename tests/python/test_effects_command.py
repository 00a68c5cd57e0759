# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw effects: the vocabulary, and each effect with all that is known of it."""

import json

import pytest

import cg2raw
from python.commands import fails, run

EFFECTS = cg2raw.effects()


def test_the_table_has_every_effect_and_parameter():
    done = run("effects")
    assert done.code == 0
    assert max(map(len, done.out.splitlines())) <= 88
    first = [line.split()[0] for line in done.out.splitlines() if line[0] != " "]
    assert first == ["name", *(effect["name"] for effect in EFFECTS)]
    words = done.out.replace(",", " ").split()
    for effect in EFFECTS:
        assert {parameter["name"] for parameter in effect["parameters"]} <= set(words)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect["name"])
def test_one_effect_is_explained(effect):
    done = run("effects", effect["name"])
    assert done.code == 0
    assert effect["meaning"] in done.out and effect["source"] in done.out
    rows = [line.split() for line in done.out.splitlines()]
    for parameter in effect["parameters"]:
        [row] = [row for row in rows if row and row[0] == parameter["name"]]
        numbers = [f"{parameter[key]:g}" for key in ("min", "max", "null")]
        unit = parameter["unit"].split()
        assert row[1 : 4 + len(unit)] == [*unit, *numbers]


def test_json_is_the_registry():
    assert json.loads(run("effects", "--json").out) == EFFECTS
    assert json.loads(run("effects", "row_noise", "--json").out)["name"] == "row_noise"


@pytest.mark.parametrize(
    ("name", "words"),
    [("Row-Noise", "did you mean row_noise?"), ("fog", "there are: ")],
)
def test_an_unknown_effect(name, words):
    line = fails("effects", name)
    assert f'unknown effect "{name}"' in line and words in line
