# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies/run mitsuba-judge where Mitsuba cannot be had: one clear line."""

import pytest


@pytest.fixture
def run(copied_script, python_without_network):
    """Return run(**environment) of a copy of the script, with few programs on PATH."""
    script = copied_script("mitsuba-judge", "requirements-mitsuba.txt")
    python_without_network("python3", "mitsuba==3.9.1")
    return script


def test_without_a_network(run, tmp_path):
    done = run()
    assert done.returncode == 1
    assert done.stderr == (
        "mitsuba-judge: Mitsuba cannot be installed: ERROR: No matching distribution "
        "found for mitsuba==3.9.1\n"
    )
    assert not (tmp_path / "build" / "mitsuba_venv" / "stamp").exists()


def test_a_named_python_without_mitsuba(run):
    done = run(CG2RAW_MITSUBA_PYTHON="/bin/false")
    assert done.returncode == 1
    assert done.stderr == (
        "mitsuba-judge: CG2RAW_MITSUBA_PYTHON: /bin/false cannot import mitsuba\n"
    )
