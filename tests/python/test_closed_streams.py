# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Whoever starts cg2raw may have closed standard input, output or error."""

import os
import subprocess
import sys

import numpy as np
import pytest

from images import write_image
from tiers import slow

CLOSED = [(0, 1, 2), *(slow(closed) for closed in ((0,), (1,), (2,), (1, 2)))]


def run(folder, command, closed):
    """Return the exit code of a command without some streams, and what it printed."""
    words = " ".join(f"{number}>&-" if number else "<&-" for number in closed)
    done = subprocess.run(
        ["sh", "-c", f'exec "$0" -m cg2raw {command} {words}', sys.executable],
        cwd=folder,
        env=dict(os.environ),
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def folder(tmp_path):
    write_image(tmp_path / "a.exr", np.full((16, 16, 3), 0.4, np.float32))
    return tmp_path


CONVERT = "convert a.exr -o a.dng --sensor nikon-d40 --illuminant D65"
DATASET = "dataset a.exr out --sensors nikon-d40 --illuminants 1 --format npy"


@pytest.mark.parametrize("closed", CLOSED)
def test_files_are_as_with_all_streams(folder, closed):
    code, said, _ = run(folder, CONVERT, ())
    expected = (folder / "a.dng").read_bytes()
    assert code == 0 and said.startswith("wrote")
    (folder / "a.dng").unlink()
    assert run(folder, CONVERT, closed) == (0, "" if 1 in closed else said, "")
    assert (folder / "a.dng").read_bytes() == expected
    assert run(folder, DATASET, closed)[::2] == (0, "")
    assert (folder / "out/manifest.parquet").is_file()


@pytest.mark.parametrize("closed", CLOSED)
def test_an_error_is_still_the_exit_code(folder, closed):
    code, said, error = run(folder, CONVERT.replace("a.exr", "none.exr"), closed)
    assert (code, said) == (1, "")
    assert error == ("" if 2 in closed else "cg2raw convert: none.exr: No such file or "
                     "directory\n")  # fmt: skip
    assert not (folder / "a.dng").exists()


def test_what_a_command_starts_has_standard_streams_too(tmp_path):
    program = (
        "import os, sys; from cg2raw.__main__ import open_standard_streams as opened;"
        "opened(); said = [os.get_inheritable(number) for number in range(3)];"
        "open(sys.argv[1], 'w').write(str(said))"
    )
    words = ["sh", "-c", 'exec "$0" -c "$1" "$2" <&- >&- 2>&-', sys.executable]
    subprocess.run([*words, program, tmp_path / "said"], check=True)
    assert (tmp_path / "said").read_text() == "[True, True, True]"
