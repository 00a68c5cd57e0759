# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rooms of the study import from those before them: no world knows a source."""

import ast
import re

import pytest

# A room is a module, those whose names go on from its own (tables_illuminant), or a
# package with all in it that is no room of its own.
ROOMS = (
    "arguments",
    "protocol",
    "places",
    "spectra",
    "illuminants",
    "world",
    "cameras",
    "sources",
    "mitsuba_judge",
    "tasks.angles",
    "learners",
    "tasks",
    "mitsuba_judge.report",
    "mitsuba_judge.main",
    "fingerprint",
    "results",
    "summaries",
    "tables",
    "draws",
    "figures",
    "docs_page",
    "main",
    "diagnose",
    "bench",
    "pictures",
)


def modules(repository):
    """Yield (dotted name below studies, path) of all but what runs in Blender."""
    folder = repository / "studies"
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        if parts[0] not in ("night_scenes", "scenes", "tests", "__init__"):
            yield ".".join(parts), path


def place(module):
    """Return the place of a module's room in ROOMS."""
    around = [room for room in ROOMS if re.match(rf"{room}(\.|_|$)", module)]
    assert around, f"{module} is in no room: give it one in ROOMS"
    return ROOMS.index(max(around, key=len))


def imported(path):
    """Yield the modules below studies that a source's import statements name."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            if node.module.startswith("studies."):
                yield node.module.removeprefix("studies.")


def test_imports_point_backwards(repository):
    found = list(modules(repository))
    assert len(found) > 20
    for name, path in found:
        late = [other for other in imported(path) if place(other) > place(name)]
        assert late == [], path


@pytest.mark.parametrize("library", ["luxpy"])
def test_no_module_imports(library, repository):
    for _, path in modules(repository):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [n for n in names if n.partition(".")[0] == library], path


def test_nothing_else_imports_the_studies(repository):
    for folder in ("python", "ocio", "scripts", "tests"):
        for path in (repository / folder).rglob("*.py"):
            found = re.findall(r"^\s*(?:from|import) studies\b", path.read_text(), re.M)
            assert not found, path
