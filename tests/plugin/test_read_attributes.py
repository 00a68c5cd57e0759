# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What the plugin's reader says of a DNG: its tags, its place in a shot, its XMP."""

import numpy as np
import pytest

import cg2raw
from images import DEVELOPED, attributes, numbers, said_of
from python import commands


def test_its_tags_are_attributes(oiiotool, ours, exr, tmp_path):
    path = tmp_path / "shot.dng"
    more = ["--attrib", "ExposureTime", 0.01, "--attrib", "Artist", "A. Person"]
    given = attributes(sensor="canon-5d-mark-iv", illuminant="A", iso=800)
    oiiotool(exr, *more, *given, "-o", path)
    said, metadata = said_of(oiiotool, ours(path)), cg2raw.read_dng_metadata(str(path))
    assert "128 x   96, 1 channel, uint16 dng" in said[""]
    assert said["channel list"] == "Y"
    assert said["Make"] == metadata.make and said["Artist"] == "A. Person"
    assert said["raw:UniqueCameraModel"] == metadata.unique_camera_model
    assert said["Exif:ISOSpeedRatings"] == said["Exif:PhotographicSensitivity"] == "800"
    assert float(said["ExposureTime"].split(" ")[0]) == 0.01
    assert said["raw:FilterPattern"] == "RGGB"
    assert numbers(said["raw:BlackLevel"]) == metadata.black_level
    assert int(said["raw:WhiteLevel"]) == metadata.white_level
    assert said["raw:ActiveArea"] == "0, 0, 96, 128"
    assert said["raw:DefaultCropSize"] == "124, 92"
    assert said["raw:CalibrationIlluminant1"] == "17"
    neutral = numbers(said["raw:AsShotNeutral"])
    np.testing.assert_allclose(neutral, metadata.as_shot_neutral, rtol=1e-5)
    assert len(numbers(said["raw:ColorMatrix2"])) == 9
    assert len(numbers(said["raw:NoiseProfile"])) == 6
    assert not [name for name in said if name.startswith("dng:")]


def test_a_frame_of_a_shot_says_so(oiiotool, ours, exr, tmp_path):
    """By OpenImageIO's names: OpenEXR keeps them, and the next DNG is one, too."""
    path, out, again = (tmp_path / name for name in ("x.dng", "x.exr", "y.dng"))
    given = attributes(sensor="nikon-d40", illuminant="A", framerate="59.94")
    given += attributes(timecode="01:02:03;05", reel="A001", camera_label="B")
    oiiotool(exr, *given, "-o", path)
    expected = {
        "FramesPerSecond": "60000/1001 (59.9401)",
        "reelName": "A001",
        "cameraLabel": "B",
    }
    place = ("FramesPerSecond", "smpte:TimeCode", "reelName", "cameraLabel")
    for hints in ((), DEVELOPED):
        said = said_of(oiiotool, ours(path), *hints)
        assert {name: said[name] for name in expected} == expected
        # Above 30 frames a second OpenEXR files count pairs: 5 is the second of one.
        assert said["smpte:TimeCode"][:8] == "01:02:03"
        assert said["smpte:TimeCode"][9:] == "02"
    oiiotool(*DEVELOPED, ours(path), "-o", out)
    kept = said_of(oiiotool, out)
    assert {name: kept[name] for name in place} == {name: said[name] for name in place}
    oiiotool(out, *attributes(sensor="nikon-d40", illuminant="D65"), "-o", again)
    read, first = (cg2raw.read_dng_metadata(str(p)).shot for p in (again, path))
    assert first["time_code"] == "01:02:03;05" and first["frame_rate"] == "60000/1001"
    for name in ("frame_rate", "time_code", "reel_name", "camera_label"):
        assert read[name] == first[name]


def test_a_still_says_nothing_of_a_shot(oiiotool, ours, exr, tmp_path):
    path = tmp_path / "x.dng"
    oiiotool(exr, *attributes(sensor="nikon-d40", illuminant="A"), "-o", path)
    said = said_of(oiiotool, ours(path))
    place = {"FramesPerSecond", "smpte:TimeCode", "reelName", "cameraLabel"}
    assert not place & set(said)


def test_its_xmp_says_that_it_is_computer_generated(oiiotool, ours, exr, tmp_path):
    """Which a developed OpenEXR file keeps."""
    path, out = tmp_path / "shot.dng", tmp_path / "picture.exr"
    run = {"sensor": "gopro-hero6-black", "illuminant": "D50", "iso": 100}
    oiiotool(exr, *attributes(**run, seed=7, frame=12), "-o", path)
    expected = {
        "Iptc4xmpExt:DigitalSourceType": (
            "http://cv.iptc.org/newscodes/digitalsourcetype/digitalCreation"
        ),
        "Software": f"cg2raw {cg2raw.__version__}",
        "cg2raw:Version": cg2raw.__version__,
        "cg2raw:Sensor": "gopro-hero6-black",
        "cg2raw:Illuminant": "D50",
        "cg2raw:ISO": "100",
        "cg2raw:Convention": "dng",
        "cg2raw:DigitalGain": "1",
        "cg2raw:Seed": "7",
        "cg2raw:Frame": "12",
        "cg2raw:Effects": "lens_shading; shot_noise; read_noise",
    }
    said = said_of(oiiotool, ours(path))
    assert {name: said[name] for name in expected} == expected
    neutral = [float(word) for word in said["cg2raw:Neutral"].split()]
    np.testing.assert_allclose(neutral, numbers(said["raw:AsShotNeutral"]), rtol=1e-5)
    assert abs(int(said["cg2raw:ColorTemperature"]) - 5000) < 10
    oiiotool(*DEVELOPED, ours(path), "-o", out)
    kept = said_of(oiiotool, out)
    of_packet = [name for name in expected if ":" in name]
    assert {n: kept[n] for n in of_packet} == {n: expected[n] for n in of_packet}


def test_openexr_keeps_the_attributes(oiiotool, ours, exr, tmp_path):
    """Where OpenImageIO has a format of the name "raw", its OpenEXR writer takes what
    begins so for that format's own, and drops it."""
    path, out = tmp_path / "shot.dng", tmp_path / "words.exr"
    oiiotool(exr, *attributes(sensor="nikon-d40", illuminant="A"), "-o", path)
    oiiotool(ours(path), "-o", out)
    kept, said = said_of(oiiotool, out), said_of(oiiotool, ours(path))
    arrays = {"raw:ActiveArea", "raw:BlackLevel", "raw:CFARepeatPatternDim"}
    arrays |= {"raw:DefaultCropOrigin", "raw:DefaultCropSize"}  # not kept
    names = {name for name in said if name.startswith("raw:")} - arrays
    assert {"raw:AsShotNeutral", "raw:ColorMatrix2", "raw:UniqueCameraModel"} <= names
    if oiiotool.name == "oiio-system":
        assert kept["Make"] == said["Make"] and not names & set(kept)
    else:
        assert {name: kept[name] for name in names} == {n: said[n] for n in names}


def test_resolutions_are_the_shape_of_pixels(oiiotool, exr, tmp_path):
    """Where nothing states it; pixels are wide where few of them fill an inch."""
    resolution = ["--attrib:type=float", "XResolution", 100]
    resolution += ["--attrib:type=float", "YResolution", 200]
    given, out = attributes(sensor="nikon-d40", illuminant="D65"), tmp_path / "a.dng"
    oiiotool(exr, "--eraseattrib", "PixelAspectRatio", *resolution, *given, "-o", out)
    assert cg2raw.read_dng_metadata(str(out)).shot["pixel_aspect"] == 2


@pytest.mark.parametrize(
    ("said", "aspect"),
    [
        ({"PixelAspectRatio": 2.0}, 2.0),
        ({"PixelAspectRatio": 0.5}, 0.5),
    ],
)
def test_the_shape_of_pixels_is_kept(oiiotool, ours, exr, tmp_path, said, aspect):
    """By both ways of writing; the picture that is developed has it again."""
    source, path, out = (tmp_path / f for f in ("a.exr", "a.dng", "b.exr"))
    words = [w for item in said.items() for w in ("--attrib:type=float", *item)]
    oiiotool(exr, *words, "-d", "float", "-o", source)
    given = attributes(sensor="nikon-d40", illuminant="D65")
    oiiotool(source, *given, "-o", path)
    for hints in ((), DEVELOPED):
        found = said_of(oiiotool, ours(path), *hints)
        assert float(found["PixelAspectRatio"]) == pytest.approx(aspect, rel=1e-4)
    assert numbers(found["raw:DefaultScale"])[0] == pytest.approx(
        max(aspect, 1.0), rel=1e-4
    )
    oiiotool(*DEVELOPED, ours(path), "-o", out)
    kept = float(said_of(oiiotool, out)["PixelAspectRatio"])
    assert kept == pytest.approx(aspect, rel=1e-4)
    options = ["--sensor", "nikon-d40", "--illuminant", "D65", "--quiet"]
    done = commands.run("convert", source, "-o", tmp_path / "b.dng", *options)
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "b.dng").read_bytes() == path.read_bytes()
