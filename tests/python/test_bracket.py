# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""--bracket: a DNG for each exposure, which hdrmerge merges."""

import os
import shutil
import subprocess

import numpy as np
import pytest
import rawpy

import cg2raw
from images import write_image
from python import commands

BASE = ["--sensor", "nikon-d850", "--illuminant", "D50", "--exposure-time", "1/60"]


@pytest.fixture
def exr(tmp_path):
    """Return a ramp of six stops, three of them beyond white."""
    ramp = 2.0 ** np.linspace(-3, 3, 256)
    pixels = np.broadcast_to(ramp[None, :, None], (192, 256, 3)).astype(np.float32)
    return write_image(tmp_path / "room.exr", pixels)


def bracket_of(exr, output, *words):
    done = commands.run("convert", exr, "-o", output, *BASE, *words, "--bracket=-3,0")
    assert done.code == 0, done
    return done


def test_files_are_named_and_tagged(exr, tmp_path):
    bracket_of(exr, tmp_path / "a.dng")
    for stops, name in ((-3, "a_ev-3.dng"), (0, "a_ev+0.dng")):
        shot = cg2raw.read_dng_metadata(tmp_path / name).shot
        assert (shot["exposure_bias"], shot["exposure_mode"]) == (stops, 2)
        assert shot["exposure_time"] == pytest.approx(2.0**stops / 60, rel=1e-4)
    assert not (tmp_path / "a.dng").exists()


def test_frames_of_a_shot_keep_their_numbers_last(exr, tmp_path):
    (tmp_path / "raw").mkdir()
    shutil.copy(exr, tmp_path / "room.0007.exr")
    done = bracket_of(tmp_path / "room.0007.exr", tmp_path / "raw", "--iso", 100)
    names = sorted(os.listdir(tmp_path / "raw"))
    assert names == ["room_ev+0.0007.dng", "room_ev-3.0007.dng"]
    assert done.out.count("frame 7") == 2 and not done.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--bracket=1,1"], "--bracket 1: is there twice"),
        (["--bracket=much"], "--bracket much: must be a number, as in -2,0,2"),
        (["--bracket=99"], "--bracket"),
    ],
)
def test_bad_brackets_are_one_line(exr, tmp_path, words, message):
    line = commands.fails("convert", exr, "-o", tmp_path / "a.dng", *BASE, *words)
    assert message in line
    assert [path.name for path in tmp_path.iterdir()] == ["room.exr"]


def test_hdrmerge_merges_them(exr, tmp_path):
    if not shutil.which("hdrmerge"):
        pytest.skip("hdrmerge is not installed")
    bracket_of(exr, tmp_path / "a.dng", "--iso", 100)
    files = [tmp_path / name for name in ("a_ev-3.dng", "a_ev+0.dng")]
    done = subprocess.run(
        ["hdrmerge", "-o", tmp_path / "merged.dng", *files],
        env={**os.environ, "QT_QPA_PLATFORM": "offscreen"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done
    with rawpy.imread(str(tmp_path / "merged.dng")) as read:
        merged = read.raw_image_visible.astype(float) - read.black_level_per_channel[0]
    # The ramp goes on where the longer exposure clips, and is one line.
    level = np.log2(np.maximum(merged[:, 16:-16].mean(axis=0), 1e-9))
    two = (level[0::2] + level[1::2]) / 2  # of both columns of the CFA
    slope = np.diff(two).mean()
    assert slope == pytest.approx(2 * 6 / 255, rel=0.05)
    line = two[0] + slope * np.arange(len(two))
    assert np.abs(two - line).max() < 0.15
