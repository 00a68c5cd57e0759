# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies/run night-scenes where Blender's module cannot be had: one clear line."""

import pytest


@pytest.fixture
def run(copied_script):
    """Return run(**environment) of a copy of the script, with few programs on PATH."""
    return copied_script("night-scenes", "requirements-bpy.txt")


def test_without_python_3_11(run):
    done = run()
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert done.stderr.startswith("night-scenes: bpy 5.0.1 needs CPython 3.11")
    assert "CG2RAW_BLENDER_PYTHON" in done.stderr


def test_without_a_network(run, python_without_network, tmp_path):
    python_without_network("python3.11", "bpy==5.0.1")
    done = run()
    assert done.returncode == 1
    assert done.stderr == (
        "night-scenes: bpy cannot be installed: ERROR: No matching distribution found "
        "for bpy==5.0.1\n"
    )
    assert not (tmp_path / "build" / "night_venv" / "stamp").exists()


def test_a_named_python_without_bpy(run):
    done = run(CG2RAW_BLENDER_PYTHON="/bin/false")
    assert done.returncode == 1
    assert done.stderr == (
        "night-scenes: CG2RAW_BLENDER_PYTHON: /bin/false cannot import bpy\n"
    )
