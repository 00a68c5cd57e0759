# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The commands of docs/sequences.md, run as they stand there."""

import os
import re
import shlex
import subprocess

import numpy as np
import pytest

from images import read_dn, write_image
from python import commands
from tiers import slow

FRAMES = range(1001, 1241)
COMMAND = re.compile(r"^    (?:.*\\\n)*.*$", re.MULTILINE)


def command_of(repository, program):
    """Return the words of the page's one command of a program, after its name."""
    page = (repository / "docs" / "sequences.md").read_text()
    found = [re.sub(r"\\\n\s*", " ", text) for text in COMMAND.findall(page)]
    (words,) = [shlex.split(text) for text in found if text.split()[0] == program]
    return words[1:]


@pytest.mark.parametrize("oiiotool", ["oiio-system", slow("oiio-wheel")], indirect=True)
def test_both_ways_write_the_shot_and_ffmpeg_plays_it(
    oiiotool, repository, program, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    pixels = np.full((32, 48, 3), 0.2, np.float32)
    first = write_image(tmp_path / "shot.1001.exr", pixels)
    for number in FRAMES[1:]:
        os.link(first, tmp_path / f"shot.{number}.exr")
    done = commands.run(*command_of(repository, "cg2raw"), "--quiet")
    assert (done.code, done.err) == (0, "")
    names = [f"shot.{number}.dng" for number in FRAMES]
    ours = {name: (tmp_path / "raw" / name).read_bytes() for name in names}
    assert len(list((tmp_path / "raw").iterdir())) == len(names)
    for name in names:
        (tmp_path / "raw" / name).unlink()
    oiiotool(*command_of(repository, "oiiotool"), cwd=tmp_path)
    theirs = {name: (tmp_path / "raw" / name).read_bytes() for name in names}
    assert theirs == ours
    assert read_dn(tmp_path / "raw" / names[-1]).shape == (32, 48)
    program("ffmpeg")
    ffmpeg = ["ffmpeg", "-v", "error", *command_of(repository, "ffmpeg")]
    subprocess.run(ffmpeg, check=True, cwd=tmp_path)
    probe = ["ffprobe", "-v", "error", "-count_frames", "-of", "csv=p=0"]
    probe += ["-show_entries", "stream=r_frame_rate,nb_read_frames", "shot.mkv"]
    said = subprocess.run(probe, check=True, cwd=tmp_path, capture_output=True)
    assert said.stdout.decode().strip() == f"24/1,{len(names)}"
