# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Type checkers and help() know the keywords of every public function."""

import ast
import dataclasses
import importlib.util
import inspect
import os
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import cg2raw
from cg2raw.exposure import RunFields

TAKE_A_RUN = ("simulate", "signal", "predict", "simulation")
# Each is the last of three lines, with what mypy says of it; None: nothing.
LINES = {
    'sensor.simulate(rgb, illuminant="D65", isoo=100)': '"isoo" for "simulate"',
    'sensor.signal(rgb, illuminant="D65", seeed=1)': '"seeed" for "signal"',
    'sensor.predict(rgb, illuminant="D65", noize="gaussian")': '"noize" for "predict"',
    "sensor.simulation((2, 2), exposure=1.0)": '"exposure" for "simulation"',
    'sensor.simulate(rgb, illuminant="D65", iso="high")': 'Argument "iso"',
    'cg2raw.Upi("nikon-d40").simulate(rgb, illuminant="A")': '"illuminant" for',
    'sensor.simulate(rgb, illuminant="D65", iso=100, seed=1, as_shot=None)': None,
}


@pytest.mark.slow
@pytest.mark.parametrize("version", ["3.10", "3.11"])
def test_mypy_sees_a_wrong_keyword(tmp_path, repository, version):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("no mypy in this Python: run scripts/setup")
    for number, line in enumerate(LINES):
        program = [
            "import cg2raw, numpy",
            'sensor, rgb = cg2raw.Sensor("nikon-d40"), numpy.zeros((4, 4, 3))',
            line,
        ]
        (tmp_path / f"of_a_user_{number}.py").write_text("\n".join(program))
    command = [sys.executable, "-m", "mypy", "--python-version", version]
    path = {**os.environ, "MYPYPATH": str(repository / "python")}
    said = subprocess.run(
        [*command, "--cache-dir", tmp_path / "cache", *sorted(tmp_path.glob("*.py"))],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=path,
    ).stdout
    for number, (line, expected) in enumerate(LINES.items()):
        start = f"of_a_user_{number}.py:3: error: "
        errors = [text for text in said.splitlines() if text.startswith(start)]
        if expected is None:
            assert errors == [], line
        else:
            assert len(errors) == 1 and expected in errors[0], (line, said)


def test_the_keywords_for_type_checkers_are_the_fields_of_run():
    fields = {field.name: field.type for field in dataclasses.fields(cg2raw.Run)}
    assert typing.get_type_hints(RunFields) == fields


@pytest.mark.parametrize("name", TAKE_A_RUN)
def test_help_lists_the_fields_of_run(name):
    method = getattr(cg2raw.Sensor, name)
    shown = inspect.signature(method).parameters
    for field in dataclasses.fields(cg2raw.Run):
        assert shown[field.name].default == field.default
        assert shown[field.name].kind is inspect.Parameter.KEYWORD_ONLY
    assert "run" not in shown
    hints = typing.get_type_hints(method)  # as libraries that check at run time do
    assert hints["iso"] == float | None and "self" not in hints


def public_functions():
    """Yield (place, ast of a function) of the rooms that Python programs call."""
    root = Path(__file__).resolve().parents[2] / "python/cg2raw"
    rooms = [*root.glob("*.py"), *root.glob("calibration/*.py")]
    rooms += [*root.glob("diagnose/*.py"), *root.glob("synthetic/*.py")]
    for path in rooms:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.name[0] != "_":
                yield f"{path.name}: {node.name}", node


def test_no_public_function_takes_any_keyword():
    found = {
        place: ast.unparse(node.args.kwarg.annotation)
        for place, node in public_functions()
        if node.args.kwarg is not None
    }
    assert len(found) == len(TAKE_A_RUN) + 1  # of Upi
    assert set(found.values()) == {"'Unpack[RunFields]'"}
