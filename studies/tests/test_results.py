# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""results.json never mixes two versions, and is the same bytes each time."""

import ast
import json
import sys
from dataclasses import replace

import pytest

from studies import results as results_module
from studies.results import (
    add,
    camera_hash,
    entry_of,
    fingerprint,
    installed,
    need_pinned,
    pinned,
    read_results,
    use,
    write_results,
)

OWN = {"cg2raw": "1", "core": "a"}


@pytest.fixture
def camera(camera_of):
    return camera_of("canon-600d")


def test_results_are_kept_and_added_to(tmp_path, camera):
    results, differs = read_results(tmp_path, OWN)
    assert differs == [] and results["cameras"] == {}
    add(results, camera, "colour", {"a": [1.0]})
    write_results(tmp_path, results)
    again, differs = read_results(tmp_path, OWN)
    assert differs == []
    add(again, camera, "classical", {"b": [2.0]})
    assert entry_of(again, camera, "colour") == {"a": [1.0]}
    assert entry_of(again, camera, "classical") == {"b": [2.0]}


@pytest.mark.parametrize("other", [{"cg2raw": "2", "core": "a"}, {"cg2raw": "1"}])
def test_another_version_is_left_out_and_named(other, tmp_path, camera):
    results, _ = read_results(tmp_path, OWN)
    add(results, camera, "colour", {})
    write_results(tmp_path, results)
    found, differs = read_results(tmp_path, other)
    assert found["cameras"] == {} and len(differs) == 1


def test_another_profile_of_the_same_name_is_another_camera(tmp_path, camera):
    results, _ = read_results(tmp_path, OWN)
    add(results, camera, "colour", {"a": 1})
    measured = replace(camera.measured, rgb=camera.measured.rgb * 0.5)
    changed = replace(camera, measured=measured)
    assert camera_hash(changed) != camera_hash(camera)
    add(results, changed, "classical", {"b": 1})
    assert entry_of(results, camera, "colour") == {}


def test_the_entry_of_another_profile_is_none(tmp_path, camera):
    results, _ = read_results(tmp_path, OWN)
    assert entry_of(results, camera, "isp") == {}
    add(results, camera, "isp", {"real": [[1.0]]})
    assert entry_of(results, camera, "isp") == {"real": [[1.0]]}
    measured = replace(camera.measured, rgb=camera.measured.rgb * 0.5)
    assert entry_of(results, replace(camera, measured=measured), "isp") == {}


def test_what_other_renders_made_is_dropped(tmp_path, camera):
    results, _ = read_results(tmp_path, OWN)
    assert not use(results, "night renders", "a")
    for name in ("isp", "isp, night renders", "isp, night renders, Mitsuba's frames"):
        add(results, camera, name, {"real": [[1.0]]})
    assert not use(results, "night renders", "a")
    assert use(results, "night renders", "b")
    assert list(results["cameras"]["canon-600d"]["studies"]) == ["isp"]


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


def test_results_of_other_seeds_are_left_out_and_named(tmp_path, camera, world):
    seeds = replace(world.protocol.seeds, real=7)
    other = replace(world, protocol=replace(world.protocol, seeds=seeds))
    results, _ = read_results(tmp_path, fingerprint(world))
    add(results, camera, "colour", {})
    write_results(tmp_path, results)
    found, differs = read_results(tmp_path, fingerprint(other))
    assert differs == ["seeds"] and found["cameras"] == {}


def test_a_package_of_another_version_is_refused_in_one_line(monkeypatch):
    need_pinned()
    other = {**installed(), "scipy": "1.0.0"}
    monkeypatch.setattr(results_module, "installed", lambda: other)
    with pytest.raises(
        ValueError, match=r"scipy 1\.0\.0 .* ./scripts/evidence"
    ) as said:
        need_pinned()
    assert "\n" not in str(said.value)


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


@pytest.mark.parametrize("text", ["", "{}", "[1]", json.dumps({"fingerprint": 1})])
def test_a_file_of_something_else_is_refused(text, tmp_path):
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(ValueError, match="is no file of this study"):
        read_results(tmp_path, OWN)
