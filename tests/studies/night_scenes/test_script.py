# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""scripts/night_scenes where Blender's module cannot be had: one clear line."""

import os
import shutil
import subprocess

import pytest

TOOLS = ("bash", "cat", "cksum", "dirname", "grep", "rm", "tail")
# Stands in for python3.11: makes an environment whose pip fails as pip does.
FAKE_PYTHON = """#!/bin/bash
mkdir=$3/bin
/bin/mkdir -p "$mkdir"
cat > "$mkdir/python" <<'EOF'
#!/bin/bash
echo "Looking in indexes: planted" >&2
echo "ERROR: No matching distribution found for bpy==5.0.1" >&2
exit 1
EOF
/bin/chmod +x "$mkdir/python"
"""


@pytest.fixture
def run(repository, tmp_path):
    """Return run(**environment) of a copy of the script, with few programs on PATH."""
    for name in ("scripts/night_scenes", "python/studies/requirements-bpy.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(repository / name, tmp_path / name)
    programs = tmp_path / "bin"
    programs.mkdir()
    for tool in TOOLS:
        (programs / tool).symlink_to(shutil.which(tool))

    def run(**environment):
        return subprocess.run(
            [tmp_path / "scripts" / "night_scenes", tmp_path / "out", "-n", "1"],
            env={
                "PATH": str(programs),
                "HOME": os.environ.get("HOME", "/"),
                **environment,
            },
            capture_output=True,
            text=True,
        )

    return run


def test_without_python_3_11(run):
    done = run()
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert done.stderr.startswith("night_scenes: bpy 5.0.1 needs CPython 3.11")
    assert "CG2RAW_BLENDER_PYTHON" in done.stderr


def test_without_a_network(run, tmp_path):
    python = tmp_path / "bin" / "python3.11"
    python.write_text(FAKE_PYTHON)
    python.chmod(0o755)
    done = run()
    assert done.returncode == 1
    assert done.stderr == (
        "night_scenes: bpy cannot be installed: ERROR: No matching distribution found "
        "for bpy==5.0.1\n"
    )
    assert not (tmp_path / "build" / "night_venv" / "stamp").exists()


def test_a_named_python_without_bpy(run):
    done = run(CG2RAW_BLENDER_PYTHON="/bin/false")
    assert done.returncode == 1
    assert done.stderr == (
        "night_scenes: CG2RAW_BLENDER_PYTHON: /bin/false cannot import bpy\n"
    )
