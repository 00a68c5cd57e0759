# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The JSON Schema of a profile against the core's reader: the same fields, and what the
one refuses the other refuses, but for what fields are to each other."""

import json
import re
from pathlib import Path

import jsonschema
import pytest

import cg2raw
from cg2raw import _core
from core.test_profile import NOISE, REQUIRED, WRONG
from oracles import cameras
from python.commands import run

ROOT = Path(__file__).parents[2]
SCHEMA = json.loads(_core.profile_schema())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def is_valid(profile):
    """Return whether the schema takes a profile, a dictionary."""
    return VALIDATOR.is_valid(profile)


def is_read(profile):
    """Return whether the core takes it."""
    try:
        cg2raw.Sensor.from_json(json.dumps(profile))
    except ValueError:
        return False
    return True


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_command_prints_it():
    assert json.loads(run("sensors", "--schema").out) == SCHEMA


@pytest.mark.parametrize("id", cg2raw.installed_profiles())
def test_every_bundled_profile_is_valid(id):
    for text in (
        cg2raw.Sensor(id).to_json(),
        (ROOT / "plugins/profiles" / f"{id}.json").read_text(),
    ):
        errors = [error.message for error in VALIDATOR.iter_errors(json.loads(text))]
        assert errors == []


def test_the_example_of_the_page_is_valid_and_read():
    page = (ROOT / "docs/profile.md").read_text()
    [text] = re.findall(r"```json\n(.*?)```", page, re.S)
    assert is_valid(json.loads(text)) and is_read(json.loads(text))
    mono = json.loads(text) | {"cfa": "mono"}
    assert not is_valid(mono) and not is_read(mono)
    for name in ("calibration_illuminant_1", "color_matrix_1"):
        del mono[name]
    assert is_valid(mono) and is_read(mono)


@pytest.mark.parametrize("field", REQUIRED)
def test_what_must_be_there_must_be_there(field):
    assert not is_valid(cameras.profile(**{field: None}))


# What one number is to another, which a schema cannot say.
RELATIONS = {
    "DN must be at least 0 and below white_level",
    "must be 1 to 16383",
    "must differ in temperature",
    "singular",
    "each channel must see white",
    "maps white to",
    "rise from row to row",
    "the root of the least beta2",
    "all rows of noise need them, or none",
    "must hold at least 3 points",
}


@pytest.mark.parametrize(("field", "value", "says"), WRONG)
def test_a_wrong_field_is_refused_unless_it_is_a_relation(field, value, says):
    profile = cameras.profile(**{field: value})
    with pytest.raises(ValueError) as refused:
        cg2raw.Sensor.from_json(json.dumps(profile))
    is_relation = any(words in str(refused.value) for words in RELATIONS)
    assert is_valid(profile) <= is_relation, refused.value


# Rules with a reader of their own; of others, fields and schema are one table.
PLACES = {
    "profile": (lambda odd: odd, lambda schema: schema),
    "illuminants": (
        lambda odd: {"illuminants": {"neutrals": [[0.5, 0.5]], **odd}},
        lambda schema: schema["properties"]["illuminants"]["oneOf"][0],
    ),
    "illuminants' hull": (
        lambda odd: {
            "illuminants": {
                "mean": [0.5, 0.5],
                "covariance": [[0.01, 0], [0, 0.01]],
                "hull": [[0.3, 0.3], [0.9, 0.3], [0.3, 0.9]],
                **odd,
            }
        },
        lambda schema: schema["properties"]["illuminants"]["oneOf"][1],
    ),
    "effects": (
        lambda odd: {
            "effects": [{"name": "prnu", "parameters": {"sigma": 0.01}, **odd}]
        },
        lambda schema: schema["properties"]["effects"]["items"]["oneOf"][0],
    ),
    "spectral_sensitivities": (
        lambda odd: {"spectral_sensitivities": {**curves(), **odd}},
        lambda schema: schema["properties"]["spectral_sensitivities"],
    ),
}


def curves():
    """Return flat spectral sensitivities."""
    nm = list(range(380, 790, 10))
    return {"wavelengths": nm, **{name: [1.0] * len(nm) for name in "RGB"}}


@pytest.mark.parametrize("place", PLACES)
def test_the_schema_has_the_fields_that_the_core_reads_and_no_others(place):
    fields, schema_of = PLACES[place]
    right = cameras.profile(**fields({}))
    assert is_valid(right) and is_read(right)
    odd = cameras.profile(**fields({"zzz": 1}))
    assert not is_valid(odd)
    with pytest.raises(ValueError) as refused:
        cg2raw.Sensor.from_json(json.dumps(odd))
    known = re.search(r"zzz is unknown; known here: (.*)", str(refused.value))[1]
    has = set(schema_of(SCHEMA)["properties"]) - {"mono"}  # of another CFA
    # The core has not asked for a field's rest where the first decides.
    assert set(known.split(", ")) - {"neutrals"} == has - {"neutrals"}


@pytest.mark.parametrize("name", [effect["name"] for effect in cg2raw.effects()])
def test_effects_have_the_bounds_of_the_registry(name):
    [known] = [effect for effect in cg2raw.effects() if effect["name"] == name]
    null = {p["name"]: p["null"] for p in known["parameters"]}
    assert is_valid(cameras.profile(effects=[{"name": name, "parameters": null}]))
    for parameter in known["parameters"]:
        for value in (parameter["max"] + 1, parameter["min"] - 1, "much"):
            wrong = {**null, parameter["name"]: value}
            assert not is_valid(
                cameras.profile(effects=[{"name": name, "parameters": wrong}])
            )
        less = {k: v for k, v in null.items() if k != parameter["name"]}
        one = cameras.profile(effects=[{"name": name, "parameters": less}])
        assert is_valid(one) == parameter["optional"]


def test_counts_of_numbers_are_those_of_the_cfa():
    for cfa in ("RGGB", cameras.QUAD, cameras.X_TRANS):
        for count in (1, 2, 3, 4, 16, 35, 36):
            one = cameras.profile(cfa=cfa, black_level=[512] * count)
            assert is_valid(one) == is_read(one) == (count in (1, 3, len(cfa)))
            row = {**NOISE, "beta1": [1e-4] * count, "beta2": 1e-6}
            one = cameras.profile(cfa=cfa, noise=[row])
            assert is_valid(one) == is_read(one)
