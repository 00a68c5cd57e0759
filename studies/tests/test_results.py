# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""results.json never mixes two versions, and is the same bytes each time."""

import ast
import json
import sys
from dataclasses import replace

import pytest

from studies import results as results_module
from studies.fingerprint import pinned
from studies.results import (
    add,
    camera_hash,
    entry_of,
    others,
    read_results,
    set_aside,
    write_results,
)

OWN = {"core": "a", "settings": {"colour": {"dark": (0.1, 0.2)}}}


@pytest.fixture
def camera(camera_of):
    return camera_of("canon-600d")


def test_results_are_kept_and_added_to(tmp_path, camera):
    results = read_results(tmp_path)
    assert results == {}
    add(results, camera, "colour", {"a": [1.0]}, OWN)
    write_results(tmp_path, results)
    again = read_results(tmp_path)
    assert others(again, "colour", OWN) == others(again, "classical", OWN) == []
    add(again, camera, "classical", {"b": [2.0]}, {"core": "another"})
    assert entry_of(again, camera, "colour") == {"a": [1.0]}
    assert entry_of(again, camera, "classical") == {"b": [2.0]}


def test_what_was_made_otherwise_is_named_and_never_mixed(tmp_path, camera, camera_of):
    results = {}
    add(results, camera, "colour", {"a": [1.0]}, OWN)
    add(results, camera, "isp", {"a": [1.0]}, OWN)
    write_results(tmp_path, results)
    kept = set_aside(tmp_path)
    assert kept.read_bytes() == (tmp_path / "results.json").read_bytes()
    other = {**OWN, "core": "b"}
    assert others(results, "colour", other) == ["core"]
    second = camera_of("nikon-d40")
    add(results, second, "colour", {"a": [2.0]}, other)
    assert entry_of(results, camera, "colour") == {}
    assert entry_of(results, second, "colour") == {"a": [2.0]}
    assert entry_of(results, camera, "isp") == {"a": [1.0]}


def test_another_camera_of_the_same_name_has_no_entry(camera):
    results = {}
    assert entry_of(results, camera, "isp") == {}
    add(results, camera, "isp", {"real": [[1.0]]}, OWN)
    assert entry_of(results, camera, "isp") == {"real": [[1.0]]}
    measured = replace(camera.measured, rgb=camera.measured.rgb * 0.5)
    cards = replace(camera.cards, neutrals=camera.cards.neutrals * 0.5)
    for other in (replace(camera, measured=measured), replace(camera, cards=cards)):
        assert camera_hash(other) != camera_hash(camera)
        assert entry_of(results, other, "isp") == {}


def test_the_same_numbers_are_the_same_bytes(tmp_path):
    for folder, keys in (("a", ("x", "y")), ("b", ("y", "x"))):
        write_results(tmp_path / folder, {key: [0.1] for key in keys})
    one, other = ((tmp_path / f / "results.json").read_bytes() for f in ("a", "b"))
    assert one == other


def test_results_are_whole_if_writing_is_interrupted(tmp_path, monkeypatch):
    write_results(tmp_path, {"a": 1})
    before = (tmp_path / "results.json").read_bytes()

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(results_module.os, "replace", stop)
    with pytest.raises(KeyboardInterrupt):
        write_results(tmp_path, {"a": 2})
    assert (tmp_path / "results.json").read_bytes() == before


def test_all_that_studies_import_is_pinned(repository):
    """By their names of distributions; cg2raw and its own modules are built here."""
    own = {"cg2raw", "oracles", "studies", "mitsuba", "bpy", "PIL", "mathutils"}
    names = {"colour": "colour-science", "tomllib": None}
    used = set()
    for room in ("world", "sources", "learners", "tasks", "figures"):
        for path in (repository / "studies" / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.Import):
                    used |= {alias.name.partition(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.module:
                    used.add(node.module.partition(".")[0])
    outside = used - own - set(sys.stdlib_module_names)
    assert {names.get(name, name) for name in outside} <= set(pinned())
    assert "torch" in outside


@pytest.mark.parametrize("text", ["", "{}", "[1]", json.dumps({"studies": {"a": 1}})])
def test_a_file_of_something_else_is_refused(text, tmp_path):
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(ValueError, match="is no file of this study"):
        read_results(tmp_path)
