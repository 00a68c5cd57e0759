# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the README runs in a clone of the repository runs to its end."""

import subprocess

import pytest

from readme import README, install


@pytest.mark.slow
def test_the_lines_of_the_readme_leave_a_shell_that_finds_everything(repository):
    script = install()[0] + "cg2raw doctor && command -v oiiotool && test -f $OCIO"
    done = subprocess.run(
        ["bash", "-ec", script], cwd=repository, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert ".venv/bin/oiiotool" in done.stdout


@pytest.mark.slow
def test_the_demo_writes_what_it_says(repository):
    assert "`./scripts/demo`" in README.read_text()
    done = subprocess.run(
        [repository / "scripts" / "demo"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    for name in ("interior.dng", "interior_ocio.dng", "night_street.dng"):
        assert name in done.stdout.partition("Written")[2]
