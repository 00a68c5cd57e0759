# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames by Blender itself, small: one always, one of each kind with --slow.

CG2RAW_BLENDER_PYTHON names a Python that can import bpy; else the environment that
studies/run night-scenes makes, if it is there or CI is set."""

import json
import os
import shutil
import subprocess

import numpy as np
import pytest

from studies.night_scenes import statistics

slow = pytest.mark.slow
WIDTH, SAMPLES = 160, 4


@pytest.fixture(scope="module")
def rendered(blender_python, studies, tmp_path_factory):
    """Return run(folder name, *indices) -> the folder with these frames."""
    root = tmp_path_factory.mktemp("night")

    def run(name, *indices):
        folder = root / name
        environment = {k: v for k, v in os.environ.items() if k != "OCIO"}
        done = subprocess.run(
            [blender_python, "-m", "studies.night_scenes.main", folder,
             "--width", str(WIDTH), "--samples", str(SAMPLES),
             "--only", *map(str, indices)],
            env={**environment, "PYTHONPATH": str(studies)},
            capture_output=True,
            text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return folder

    return run


@pytest.fixture(scope="module")
def kinds(rendered):
    """Return the folder of one frame of each kind."""
    return rendered("kinds", 24, 5, 6, 3)


def is_a_night(pixels):
    """Return whether pixels are finite, dark on the whole, with lamps above white."""
    median = np.median(pixels @ statistics.LUMINANCE)
    return np.isfinite(pixels).all() and 0.002 < median < 0.5 and pixels.max() > 1


def test_one_frame_is_rendered_described_and_kept(rendered):
    folder = rendered("one", 3)
    assert sorted(path.name for path in folder.iterdir()) == [
        "night_0003.exr", "night_0003.json",
    ]  # fmt: skip
    ((index, pixels, described),) = statistics.frames(folder)
    assert index == 3 and described["scene"]["layout"] == "bar"
    assert pixels.shape == (90, 160, 3) and is_a_night(pixels)
    before = (folder / "night_0003.exr").stat().st_mtime_ns
    rendered("one", 3)
    assert (folder / "night_0003.exr").stat().st_mtime_ns == before


@slow
def test_frames_are_scene_linear_pictures_of_a_night(kinds):
    frames = list(statistics.frames(kinds))
    assert [index for index, *_ in frames] == [3, 5, 6, 24]
    for index, pixels, described in frames:
        assert pixels.shape == (90, 160, 3)
        assert is_a_night(pixels), index
        assert described["scene"]["index"] == index


@slow
def test_the_file_says_what_it_shows(kinds):
    import OpenImageIO as oiio

    spec = oiio.ImageInput.open(str(kinds / "night_0005.exr")).spec()
    assert spec.get_string_attribute("compression").startswith("dwaa")
    assert spec.format == oiio.HALF and spec.nchannels == 3
    note = json.loads(spec.get_string_attribute("Note"))
    assert note == {"scene": 5, "kind": "square", "layout": "market ring"}


@slow
def test_frames_differ(kinds):
    found = statistics.measure(kinds)
    assert found["closest"] > statistics.ALIKE
    assert statistics.report(kinds).startswith("frames            4 (1 interior")


@slow
def test_the_same_index_is_the_same_picture(kinds, rendered):
    again = rendered("again", 3)
    first, second = (folder / "night_0003.exr" for folder in (kinds, again))
    pixels = [next(statistics.frames(folder))[1] for folder in (kinds, again)]
    assert np.array_equal(*pixels), (first, second)


@slow
def test_a_frame_becomes_a_dng(kinds, tmp_path):
    import cg2raw

    _, pixels, _ = next(statistics.frames(kinds))
    camera = cg2raw.Sensor("samsung-s20fe").to_camera(pixels, illuminant="sample:1")
    assert np.isfinite(camera).all() and camera.shape == pixels.shape


@slow
def test_a_full_disk_is_one_line(blender_python, studies, tmp_path):
    if os.geteuid() or not shutil.which("mount"):
        pytest.skip("mounting a small file system needs root")
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "none", disk])
    if mounted.returncode:
        pytest.skip("cannot mount here")
    try:
        done = subprocess.run(
            [blender_python, "-m", "studies.night_scenes.main", disk / "night",
             "-n", "1", "--first", "3", "--width", "320", "--samples", "1"],
            env={**os.environ, "PYTHONPATH": str(studies)},
            capture_output=True,
            text=True,
        )  # fmt: skip
        assert done.returncode == 1
        assert done.stderr.count("\n") == 1 and "0 MiB are left" in done.stderr
        assert not list((disk / "night").iterdir())
    finally:
        subprocess.run(["umount", disk], check=True)
