# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw convert: frame numbers of sequences, which their noise is drawn by."""

import json
import shutil

import numpy as np
import pytest

import cg2raw
from cg2raw.io.image_file import read_image
from images import write_image
from python import commands

BASE = ["--sensor", "samsung-s20fe", "--illuminant", "D65"]
NUMBERED = ["shot.0007.exr", "shot.0008.exr", "still.exr"]
FRAMES = {
    "names": ([], [7, 8, 0]),
    "name": (["--frame-from", "name"], [7, 8, 0]),
    "index": (["--frame-from", "index"], [0, 1, 2]),
    "index from": (["--frame-from", "index", "--frame", 5], [5, 6, 7]),
    "none": (["--frame-from", "none"], [0, 0, 0]),
    "one": (["--frame", 3], [3, 3, 3]),
}


@pytest.fixture(scope="module")
def scene():
    """Return a (66, 98, 3) float32 image."""
    return np.random.default_rng(1).random((66, 98, 3), dtype=np.float32)


@pytest.fixture
def exr(tmp_path, scene):
    return write_image(tmp_path / "scene.exr", scene)


@pytest.mark.parametrize("name", FRAMES)
def test_frames_of_several_inputs(exr, scene, tmp_path, name):
    words, numbers = FRAMES[name]
    inputs = [shutil.copy(exr, tmp_path / name) for name in NUMBERED]
    out = tmp_path / "out"
    done = commands.run(
        "convert", *inputs, "-o", out, *BASE, "--iso", 800, *words, "--json"
    )
    assert done.code == 0, done.err
    assert [file["frame"] for file in json.loads(done.out)["files"]] == numbers
    sensor = cg2raw.Sensor("samsung-s20fe")
    for path, number in zip(NUMBERED, numbers, strict=True):
        raw = sensor.simulate(scene, illuminant="D65", iso=800, frame=number)
        same = tmp_path / "same.dng"
        cg2raw.write_dng(same, raw, shot=read_image(exr).shot)
        written = (out / path).with_suffix(".dng")
        assert written.read_bytes() == same.read_bytes()
    alike = len(set(numbers)) == 1
    assert (f"3 files are frame {numbers[0]}" in done.err) == alike


def test_the_name_of_the_input_counts_where_the_output_has_no_number(exr, tmp_path):
    shot = shutil.copy(exr, tmp_path / "shot.0007.exr")
    for name, number in (("x.dng", 7), ("x.0009.dng", 9)):
        done = commands.run("convert", shot, "-o", tmp_path / name, *BASE, "--json")
        (file,) = json.loads(done.out)["files"]
        assert file["frame"] == number


def test_two_inputs_of_one_number_are_one_error(exr, tmp_path):
    inputs = []
    for folder in ("left", "right"):
        (tmp_path / folder).mkdir()
        inputs.append(shutil.copy(exr, tmp_path / folder / "shot.0007.exr"))
    said = commands.fails("convert", *inputs, "-o", tmp_path / "s.####.dng", *BASE)
    assert f"{inputs[1]}: would become {tmp_path / 's.0007.dng'}, as" in said
    assert not list(tmp_path.glob("*.dng"))
