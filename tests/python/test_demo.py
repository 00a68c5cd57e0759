# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The first command that README names runs to its end."""

import subprocess

import pytest


@pytest.mark.slow
def test_the_demo_writes_what_it_says(repository):
    done = subprocess.run(
        [repository / "scripts" / "demo"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    for name in ("interior.dng", "interior_ocio.dng", "night_street.dng"):
        assert name in done.stdout.partition("Written")[2]
