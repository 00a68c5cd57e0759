# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""scripts/mitsuba_judge where Mitsuba cannot be had: one clear line."""

import os
import shutil
import subprocess

import pytest

TOOLS = ("bash", "cat", "cksum", "dirname", "grep", "rm", "tail")
# Stands in for python3: makes an environment whose pip fails as pip does.
FAKE_PYTHON = """#!/bin/bash
/bin/mkdir -p "$3/bin"
cat > "$3/bin/python" <<'EOF'
#!/bin/bash
echo "Looking in indexes: planted" >&2
echo "ERROR: No matching distribution found for mitsuba==3.9.1" >&2
exit 1
EOF
/bin/chmod +x "$3/bin/python"
"""


@pytest.fixture
def run(repository, tmp_path):
    """Return run(**environment) of a copy of the script, with few programs on PATH."""
    for name in ("scripts/mitsuba_judge", "python/studies/requirements-mitsuba.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(repository / name, tmp_path / name)
    programs = tmp_path / "bin"
    programs.mkdir()
    for tool in TOOLS:
        (programs / tool).symlink_to(shutil.which(tool))
    python = programs / "python3"
    python.write_text(FAKE_PYTHON)
    python.chmod(0o755)

    def run(**environment):
        home = os.environ.get("HOME", "/")
        return subprocess.run(
            [tmp_path / "scripts" / "mitsuba_judge", tmp_path / "out", "-n", "1"],
            env={"PATH": str(programs), "HOME": home, **environment},
            capture_output=True,
            text=True,
        )

    return run


def test_without_a_network(run, tmp_path):
    done = run()
    assert done.returncode == 1
    assert done.stderr == (
        "mitsuba_judge: Mitsuba cannot be installed: ERROR: No matching distribution "
        "found for mitsuba==3.9.1\n"
    )
    assert not (tmp_path / "build" / "mitsuba_venv" / "stamp").exists()


def test_a_named_python_without_mitsuba(run):
    done = run(CG2RAW_MITSUBA_PYTHON="/bin/false")
    assert done.returncode == 1
    assert done.stderr == (
        "mitsuba_judge: CG2RAW_MITSUBA_PYTHON: /bin/false cannot import mitsuba\n"
    )
