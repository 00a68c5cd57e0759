# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Seeds with a name are synthetic: scripts write each byte of them."""

import json
import re
from pathlib import Path

import pytest

import cg2raw
from fuzz import (
    illuminant_seeds,
    jpeg_seeds,
    make_seeds,
    mosaic_seeds,
    plugin_seeds,
    python_seeds,
)

HERE = Path(__file__).parent
OTHERS = re.compile(r"found_\w+|[0-9a-f]{40}")


SCRIPTS = {
    "captures": python_seeds,
    "dng": make_seeds,
    "illuminant": illuminant_seeds,
    "journal": python_seeds,
    "jpeg": jpeg_seeds,
    "mosaic": mosaic_seeds,
    "plugin": plugin_seeds,
    "profile": make_seeds,
    "spectra": make_seeds,
}


@pytest.mark.parametrize("kind", SCRIPTS)
def test_seeds_are_those_of_the_script(tmp_path, kind):
    SCRIPTS[kind].main(tmp_path)
    made = {path.name: path.read_bytes() for path in (tmp_path / kind).iterdir()}
    kept = {
        path.name: path.read_bytes()
        for path in (HERE / kind).iterdir()
        if not OTHERS.fullmatch(path.name)
    }
    assert kept == made


def test_effects_of_seeds_are_those_of_the_registry():
    """Parameters under other names would be refused before they are looked at."""
    known = {effect["name"]: effect["parameters"] for effect in cg2raw.effects()}
    listed = json.loads(make_seeds.profiles()["effects"])["effects"]
    assert {"lens_shading", "row_noise"} <= {effect["name"] for effect in listed}
    for effect in listed:
        parameters = set(effect.get("parameters", {}))
        of_effect = known[effect["name"]]
        needed = {one["name"] for one in of_effect if not one["optional"]}
        assert parameters <= {one["name"] for one in of_effect}, effect["name"]
        assert not parameters or parameters >= needed, effect["name"]
