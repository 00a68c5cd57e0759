# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sequences by oiiotool: frames of a shot, the same bytes as cg2raw convert writes."""

import OpenImageIO as oiio
import pytest
import tifffile

from images import attributes, write_image
from python import commands

RUN = {"sensor": "samsung-s20fe", "illuminant": "D65", "iso": 1600}
NOISY = attributes(**RUN)
WORDS = [word for name, value in RUN.items() for word in (f"--{name}", value)]
RATIONAL = oiio.TypeDesc(oiio.INT, oiio.VEC2, oiio.RATIONAL)
FRAMES = (1001, 1002, 1003)
TIME_CODES, FRAME_RATE, REEL_NAME, CAMERA_LABEL = 51043, 51044, 51081, 51105


def packed(hours, minutes, seconds, frames, drop=False):
    """Return what an OpenEXR file holds of a time code."""
    digits = [int(str(n), 16) for n in (hours, minutes, seconds, frames)]
    return int.from_bytes(digits, "big") | (0x40 if drop else 0), 0


def tags(path):
    """Return {number: value} of IFD0."""
    with tifffile.TiffFile(path) as tiff:
        return {tag.code: tag.value for tag in tiff.pages[0].tags}


@pytest.fixture
def shot(tmp_path, scene):
    """Return the folder of three frames without any word on the shot."""
    for number in FRAMES:
        write_image(tmp_path / f"shot.{number}.exr", scene)
    return tmp_path


@pytest.mark.parametrize("pattern", ["shot.#", "shot.@@@@", "shot.%04d"])
def test_a_sequence_is_that_of_convert(oiiotool, shot, pattern):
    said = {"framerate": "23.976", "timecode": "01:00:00:23", "first_frame": 1001}
    said |= {"reel": "A001", "camera_label": "B"}
    out = shot / "raw"
    out.mkdir()
    words = ["--frames", "1001-1003", shot / f"{pattern}.exr", *NOISY]
    oiiotool(*words, *attributes(**said), "-o", out / f"{pattern}.dng")
    more = ["--framerate", "23.976", "--timecode", "01:00:00:23", "--reel", "A001"]
    inputs = [shot / f"{pattern}.exr", "--camera-label", "B", *more]
    done = commands.run("convert", *inputs, "-o", shot / "ours", *WORDS)
    assert (done.code, done.err) == (0, "")
    seconds = []
    for number in FRAMES:
        file = out / f"shot.{number}.dng"
        assert file.read_bytes() == (shot / "ours" / file.name).read_bytes()
        found = tags(file)
        assert found[FRAME_RATE] == (24000, 1001)
        assert (found[REEL_NAME], found[CAMERA_LABEL]) == ("A001", "B")
        seconds.append(tuple(found[TIME_CODES][:4]))
    assert seconds == [(0x23, 0, 0, 1), (0, 1, 0, 1), (1, 1, 0, 1)]


def test_what_the_image_says(oiiotool, tmp_path, scene):
    typed = [
        ("FramesPerSecond", RATIONAL, (30000, 1001)),
        ("smpte:TimeCode", oiio.TypeTimeCode, packed(1, 2, 3, 4, drop=True)),
    ]
    said = {"reelName": "R7", "cameraLabel": "C"}
    exr = write_image(tmp_path / "x.exr", scene, said, typed=typed)
    oiiotool(exr, *NOISY, "-o", tmp_path / "x.dng")
    found = tags(tmp_path / "x.dng")
    assert found[FRAME_RATE] == (30000, 1001)
    assert found[TIME_CODES] == bytes([0x44, 3, 2, 1, 0, 0, 0, 0])
    assert (found[REEL_NAME], found[CAMERA_LABEL]) == ("R7", "C")
    done = commands.run("convert", exr, "-o", tmp_path / "ours.dng", *WORDS)
    assert done.code == 0, done.err
    words = attributes(framerate=25, reel="mine", camera_label="")
    assert (tmp_path / "ours.dng").read_bytes() == (tmp_path / "x.dng").read_bytes()
    words += attributes(timecode="02:00:00:00", first_frame=1020304)
    oiiotool(exr, *NOISY, *words, "-o", tmp_path / "other.dng")
    found = tags(tmp_path / "other.dng")
    assert found[FRAME_RATE] == (25, 1) and found[REEL_NAME] == "mine"
    assert found[TIME_CODES] == bytes([0, 0, 0, 2, 0, 0, 0, 0])
