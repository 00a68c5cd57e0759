# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""dng:reference: a real DNG of the target camera, and ours in its image."""

import json
import subprocess

import numpy as np
import pytest

import cg2raw
from images import attributes, read_dn, write_image
from oracles import cameras

SAME = [
    "Make",
    "Model",
    "UniqueCameraModel",
    "CFAPattern",
    "CalibrationIlluminant1",
    "CalibrationIlluminant2",
    "ColorMatrix1",
    "ColorMatrix2",
    "ExposureTime",
    "FNumber",
    "ISO",
    "WhiteLevel",
]


def tags(program, path):
    """Return exiftool's numbers of a file; SubIFD's raw tags win over a preview's."""
    command = [program("exiftool"), "-j", "-n", "-a", path]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)[
        0
    ]


@pytest.fixture
def reference(camera_data):
    """Return the path of a real DNG with two matrices, a neutral and noise."""
    return camera_data / "real" / "Hero6_GOPR0024.dng"


def test_ours_is_in_the_image_of_the_reference(
    oiiotool, program, reference, exr, tmp_path
):
    out = tmp_path / "shot.dng"
    given = attributes(reference=reference, illuminant="as-shot", preview=0)
    oiiotool(exr, *given, "-o", out)
    ours, theirs = tags(program, out), tags(program, reference)
    for name in SAME:
        assert ours.get(name) == theirs.get(name), name
    neutral = np.array(ours["AsShotNeutral"].split(), float)
    expected = np.array(theirs["AsShotNeutral"].split(), float)
    np.testing.assert_allclose(neutral / neutral[1], expected / expected[1], atol=2e-6)


def test_a_reference_s_place_in_a_shot_is_its_own(oiiotool, camera_data, exr, tmp_path):
    """The file is a frame of another shot, or of none; two frames with one time code
    would be one frame of a clip."""
    real = camera_data / "real" / "bmpcc_twelvemonkeys.dng"
    theirs = cg2raw.read_dng_metadata(str(real)).shot
    assert theirs["frame_rate"] == "30" and theirs["time_code"]
    given = attributes(reference=real, illuminant="as-shot")
    oiiotool(exr, *given, "-o", tmp_path / "still.dng")
    still = cg2raw.read_dng_metadata(str(tmp_path / "still.dng")).shot
    assert still["frame_rate"] is None and still["time_code"] is None
    place = attributes(framerate=24, timecode="10:00:00:00", first_frame=0, frame=1)
    oiiotool(exr, *given, *place, "-o", tmp_path / "frame.dng")
    frame = cg2raw.read_dng_metadata(str(tmp_path / "frame.dng")).shot
    assert (frame["frame_rate"], frame["time_code"]) == ("24", "10:00:00:01")


def test_pixels_are_those_of_the_reference_s_profile(
    oiiotool, reference, exr, scene, tmp_path
):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *attributes(reference=reference, illuminant="D50"), "-o", out)
    sensor = cg2raw.Sensor.from_dng(reference)
    np.testing.assert_array_equal(
        read_dn(out), sensor.simulate(scene, illuminant="D50")
    )


def test_a_reference_of_another_camera_than_the_sensor(
    oiiotool, reference, exr, tmp_path
):
    out = tmp_path / "shot.dng"
    given = attributes(reference=reference, sensor="nikon-d40", illuminant="D50")
    done = oiiotool(exr, *given, "-o", out, check=False)
    message = done.stdout + done.stderr
    assert done.returncode != 0
    assert "HERO6" in message and "nikon-d40" in message
    assert not out.exists()


@pytest.fixture
def x_trans(tmp_path):
    """Return the path of an X-Trans sensor's profile."""
    path = tmp_path / "x-trans.json"
    # The id that a reference, too, gives a camera of this name.
    named = {"id": "x-trans", "unique_camera_model": "X-Trans"}
    path.write_text(cameras.profile_text(cfa=cameras.X_TRANS, noise=None, **named))
    return path


def test_x_trans_pixels_are_those_of_the_profile(
    oiiotool, exr, scene, x_trans, tmp_path
):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *attributes(sensor=x_trans, illuminant="D50"), "-o", out)
    expected = cg2raw.Sensor(str(x_trans)).simulate(scene, illuminant="D50")
    np.testing.assert_array_equal(read_dn(out), expected)
    assert cg2raw.read_dng_metadata(str(out)).cfa == cameras.X_TRANS


@pytest.mark.parametrize("cfa", ["Bayer", "X-Trans"])
def test_reference_of_ours_gives_the_same_file(oiiotool, exr, cfa, x_trans, tmp_path):
    first, second = tmp_path / "first.dng", tmp_path / "second.dng"
    base = attributes(illuminant="D65", compression="none", preview=0)
    sensor = "nikon-d40" if cfa == "Bayer" else x_trans
    oiiotool(exr, *attributes(sensor=sensor), *base, "-o", first)
    oiiotool(exr, *attributes(reference=first), *base, "-o", second)
    assert first.read_bytes() == second.read_bytes()


def test_a_render_of_another_size_is_written_at_its_size(oiiotool, reference, tmp_path):
    exr = write_image(tmp_path / "in.exr", np.full((50, 70, 3), 0.2, np.float32))
    out = tmp_path / "shot.dng"
    oiiotool(exr, *attributes(reference=reference, illuminant="as-shot"), "-o", out)
    assert read_dn(out).shape == (50, 70)


def test_the_shading_of_the_reference_is_simulated(
    oiiotool, program, reference, tmp_path
):
    exr = write_image(tmp_path / "in.exr", np.full((60, 80, 3), 0.2, np.float32))
    out = tmp_path / "shot.dng"
    given = attributes(reference=reference, illuminant="as-shot", preview=0)
    oiiotool(exr, *given, "-o", out)
    dn = read_dn(out)[::2, ::2].astype(float)  # red; black is 0
    # The reference's own gain in that corner is 1.79, but for 3.6 %.
    assert dn[0, 0] / dn[15, 20] == pytest.approx(1 / 1.79, abs=0.04)
    assert "OpcodeList2" in tags(program, out)  # and readers undo it
