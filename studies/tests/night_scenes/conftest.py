# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A Python that has Blender's module bpy."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def studies():
    """Return the folder that python -m studies.night_scenes.main needs on its path."""
    return ROOT


@pytest.fixture(scope="session")
def blender_python(tmp_path_factory):
    """Return a Python with bpy: the one named, or that of studies/run night-scenes.

    The latter is made (1 GB) only where CI is set."""
    named = os.environ.get("CG2RAW_BLENDER_PYTHON")
    python = named or ROOT / "build" / "night_venv" / "bin" / "python"
    if not named and not os.path.exists(python) and os.environ.get("CI"):
        folder = tmp_path_factory.mktemp("first")
        script = [ROOT / "studies" / "run", "night-scenes", folder, "-n", "1"]
        subprocess.run([*script, "--width", "160", "--samples", "4"])
    if not named and not os.path.exists(python):
        pytest.skip("no bpy: CG2RAW_BLENDER_PYTHON names a Python with it")
    found = subprocess.run([python, "-c", "import bpy"], capture_output=True, text=True)
    if found.returncode and named:
        pytest.fail(f"CG2RAW_BLENDER_PYTHON: {named} cannot import bpy")
    if found.returncode:
        pytest.skip(f"{python} cannot import bpy")
    return str(python)
