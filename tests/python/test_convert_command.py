# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw convert: the same bytes as the other routes, and what it refuses."""

import argparse
import json
import shutil

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw.cli.convert import exposure_words, workers
from cg2raw.io.image_file import read_image
from images import read_dn, write_image
from match.match_sets import match_file
from python import commands

BASE = ["--sensor", "samsung-s20fe", "--illuminant", "D65"]
UPI = ["--sensor", "nikon-d40", "--method", "upi"]
# Sensor, illuminant, ISO, seed, convention: CFAs, levels and bits of all kinds.
COMBINATIONS = [
    ("samsung-s20fe", "2856K", 3200, 7, "dng"),
    ("samsung-s20fe", "sample:3", 100, 0, "paper"),
    ("samsung-s20fe", "xy:0.3457:0.3585", 1600.7, 18446744073709551615, "dng"),
    ("nikon-d40", "A", None, 1, "dng"),
    ("nikon-d40", "sample:11", None, 2, "paper"),
    ("canon-5d-mark-iv", "neutral:0.55:0.45", 6400, 3, "dng"),
    ("canon-70d", "D50", 800, 4, "paper"),
    ("sony-a7s-ii", "3200K", 12800, 5, "dng"),
    ("fujifilm-x-m1", "D75", None, 6, "dng"),
    ("gopro-hero6-black", "A", 100, 8, "dng"),
    ("nikon-d850", "D55", 100, 9, "dng"),
    ("blackmagic-pocket", "4000K", None, 10, "paper"),
    ("nikon-d850", "FL2", 400, 11, "spectral"),
    ("canon-600d", "sample:5", None, 12, "spectral"),
]


@pytest.fixture
def exr(tmp_path, scene):
    return write_image(tmp_path / "scene.exr", scene)


def plugin_arguments(seed, **values):
    """Return oiiotool's arguments; large seeds must be texts."""
    words = ["--attrib:type=string", "dng:seed", str(seed)]
    for name, value in values.items():
        if value is not None:
            words += ["--attrib", f"dng:{name}", str(value)]
    return words


@pytest.mark.parametrize("combination", COMBINATIONS, ids=str)
def test_three_routes_write_the_same_bytes(oiiotool, exr, scene, tmp_path, combination):
    id, light, iso, seed, convention = combination
    ours = tmp_path / "command.dng"
    words = ["--sensor", id, "--illuminant", light, "--seed", seed]
    words += ["--convention", convention] + ([] if iso is None else ["--iso", iso])
    done = commands.run("convert", exr, "-o", ours, *words)
    assert (done.code, done.err) == (0, "")
    raw = cg2raw.Sensor(id).simulate(
        scene, illuminant=light, iso=iso, seed=seed, convention=convention
    )
    shot = read_image(exr).shot  # OpenEXR files say when they were written
    cg2raw.write_dng(tmp_path / "python.dng", raw, shot=shot)
    assert (tmp_path / "python.dng").read_bytes() == ours.read_bytes()
    out = tmp_path / "plugin.dng"
    given = {"sensor": id, "illuminant": light, "iso": iso}
    arguments = plugin_arguments(seed, **given, convention=convention)
    oiiotool(exr, *arguments, "-o", out)
    assert out.read_bytes() == ours.read_bytes()


def test_three_routes_match_captures(oiiotool, exr, scene, tmp_path):
    rule, ours = match_file(tmp_path), tmp_path / "command.dng"
    words = ["--sensor", "samsung-s20fe", "--illuminant", "A", "--exposure", rule]
    done = commands.run("convert", exr, "-o", ours, *words)
    assert done.code == 0 and "exposure " in done.out
    raw = cg2raw.Sensor("samsung-s20fe").simulate(scene, illuminant="A", exposure=rule)
    assert raw.simulation.exposure["stops"] not in (0, None)
    cg2raw.write_dng(tmp_path / "python.dng", raw, shot=read_image(exr).shot)
    assert (tmp_path / "python.dng").read_bytes() == ours.read_bytes()
    given = {"sensor": "samsung-s20fe", "illuminant": "A", "exposure": rule}
    oiiotool(exr, *plugin_arguments(0, **given), "-o", tmp_path / "plugin.dng")
    assert (tmp_path / "plugin.dng").read_bytes() == ours.read_bytes()


OPTIONS = {
    "gain": (["--digital-gain", 0.7], {"digital_gain": 0.7}),
    "sampled gain": (["--digital-gain", "sample"], {"digital_gain": "sample"}),
    "stops": (["--exposure=-1.5"], {"exposure": -1.5}),
    "metered": (["--exposure", "auto:90:0.5"], {"exposure": "auto:90:0.5"}),
    "settings": (
        [
            *("--scene-luminance", 80, "--f-number", 2, "--nd-filter", 1),
            *("--exposure-time", "1/60", "--iso", 400),
        ],
        {
            "scene_luminance": 80,
            "f_number": 2,
            "exposure_time": "1/60",
            "iso": 400,
            "nd_filter": 1,
        },
    ),
    "no highlights": (["--no-highlights"], {"highlights": 0}),
    "frame": (["--iso", 800, "--frame", 5], {"ISO": 800, "frame": 5}),
    "noise": (
        ["--iso", 800, "--noise", "gaussian"],
        {"iso": 800, "noise": "gaussian"},
    ),
    "no effects": (
        ["--iso", 800, "--effects", "none"],
        {"iso": 800, "effects": "none"},
    ),
    "exact": (["--matrices", "exact"], {"matrices": "exact"}),
    "uncompressed": (["--compression", "none"], {"compression": "none"}),
    "no preview": (["--no-preview"], {"preview": 0}),
    "whole": (["--crop", "none"], {"crop": "none"}),
    "linear": (["--tone-curve", "linear"], {"tone_curve": "linear"}),
    "shot": (
        ["--framerate", 24, "--timecode", "01:00:00:00", "--reel", "A"],
        {"framerate": 24, "timecode": "01:00:00:00", "reel": "A"},
    ),
    "label": (["--camera-label", "B", "--framerate", 24], {"camera_label": "B"}),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_each_option_is_the_attribute(exr, tmp_path, name):
    words, given = OPTIONS[name]
    ours, same, plain = (tmp_path / f"{n}.dng" for n in ("ours", "same", "plain"))
    assert commands.run("convert", exr, "-o", ours, *BASE, *words).code == 0
    given = [word for key, v in given.items() for word in ("--attrib", f"dng:{key}", v)]
    given += ["--framerate", 24] if name == "label" else []
    assert commands.run("convert", exr, "-o", same, *BASE, *given).code == 0
    assert ours.read_bytes() == same.read_bytes()
    assert commands.run("convert", exr, "-o", plain, *BASE).code == 0
    assert plain.read_bytes() != ours.read_bytes()


def test_an_attribute_comes_before_the_option(exr, tmp_path):
    ours, same = tmp_path / "ours.dng", tmp_path / "same.dng"
    words = ["--crop", "border", "--attrib", "dng:crop", "none"]
    assert commands.run("convert", exr, "-o", ours, *BASE, *words).code == 0
    assert commands.run("convert", exr, "-o", same, *BASE, "--crop", "none").code == 0
    assert ours.read_bytes() == same.read_bytes()


SAID = {
    "ExposureTime": 0.004,
    "FNumber": 2.8,
    "Exif:FocalLength": 35.0,
    "DateTime": "2024:02:03 04:05:06",
    "Artist": "A. Painter",
    "Copyright": "nobody's",
    "ImageDescription": "a test",
    "Orientation": 6,
}


@pytest.mark.parametrize("ending", ["exr", "tif"])
@pytest.mark.parametrize("reference", [False, True])
def test_exif_of_image_and_reference(tmp_path, scene, ending, reference, oiiotool):
    image = write_image(
        tmp_path / f"said.{ending}",
        np.nan_to_num(scene, posinf=4.0),
        {**SAID, "oiio:ColorSpace": "lin_rec709"},
    )
    words, given = [], {}
    if reference:
        path = commands.write_dng(tmp_path / "reference.dng", "A")
        words = ["--reference", path, "--illuminant", "as-shot"]
        given = {"reference": path, "illuminant": "as-shot"}
    else:
        words, given = BASE, {"sensor": "samsung-s20fe", "illuminant": "D65"}
    ours, theirs = tmp_path / "ours.dng", tmp_path / "theirs.dng"
    space = ["--iscolorspace", "lin_rec709"]  # OpenImageIO takes any TIFF for sRGB
    done = commands.run("convert", image, "-o", ours, *space, *words)
    assert done.code == 0, done.err
    oiiotool(image, *space, *plugin_arguments(0, **given), "-o", theirs)
    assert ours.read_bytes() == theirs.read_bytes()
    shot = cg2raw.read_dng_metadata(str(ours)).shot
    assert shot["f_number"] == pytest.approx(2.8)
    assert shot["orientation"] == 6


def test_a_data_window_is_padded_as_oiiotool_does(tmp_path, scene, oiiotool):
    image = oiio.ImageBuf(oiio.ImageSpec(98, 66, 3, "float"))
    image.set_pixels(oiio.ROI(), np.nan_to_num(scene, posinf=4.0))
    image.specmod().x, image.specmod().y = -7, 12
    image.specmod().full_width, image.specmod().full_height = 80, 90
    exr = tmp_path / "window.exr"
    assert image.write(str(exr))
    ours, theirs = tmp_path / "ours.dng", tmp_path / "theirs.dng"
    assert commands.run("convert", exr, "-o", ours, *BASE).code == 0
    given = plugin_arguments(0, sensor="samsung-s20fe", illuminant="D65")
    oiiotool(exr, *given, "-o", theirs)
    assert ours.read_bytes() == theirs.read_bytes()


def test_exposure_is_mulc(exr, tmp_path, oiiotool):
    ours, theirs = tmp_path / "ours.dng", tmp_path / "theirs.dng"
    done = commands.run("convert", exr, "-o", ours, *BASE, "--exposure", -2)
    assert done.code == 0
    given = plugin_arguments(0, sensor="samsung-s20fe", illuminant="D65")
    oiiotool(exr, "--mulc", 0.25, *given, "-o", theirs)
    np.testing.assert_array_equal(read_dn(ours), read_dn(theirs))


def test_pixels_that_are_raw(tmp_path, scene):
    pixels = np.nan_to_num(scene, posinf=4.0)
    sensor = cg2raw.Sensor("nikon-d40")
    camera = sensor.to_camera(pixels, illuminant="A")
    exr = write_image(tmp_path / "camera.exr", camera)
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    space = ["--iscolorspace", "RAW - nikon-d40 - A"]
    done = commands.run("convert", exr, "-o", out, *space)
    assert done.code == 0, done.err
    shot = read_image(exr).shot
    converted = {"camera_input": True, "color_effects": False}
    raw = sensor.simulate(camera, illuminant="A", **converted)
    np.testing.assert_array_equal(raw, sensor.simulate(pixels, illuminant="A"))
    cg2raw.write_dng(same, raw, shot=shot)
    assert out.read_bytes() == same.read_bytes()
    for words in (
        ["--sensor", "canon-5d"],
        ["--illuminant", "D50"],
        ["--digital-gain", 2],
    ):
        line = commands.fails("convert", exr, "-o", out, *space, *words)
        assert "already are" in line and words[0] in line


def test_srgb_pictures_are_refused_or_linearised(tmp_path):
    codes = np.arange(256, dtype=np.float32).repeat(3).reshape(16, 16, 3) / 255
    png = write_image(tmp_path / "display.png", codes)
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    line = commands.fails("convert", png, "-o", out, *BASE)
    assert "--linearize srgb" in line and not out.exists()
    done = commands.run("convert", png, "-o", out, *BASE, "--linearize", "srgb")
    assert done.code == 0 and "sRGB's curve undone" in done.out
    v = codes.astype(float)
    # IEC 61966-2-1
    linear = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)
    raw = cg2raw.Sensor("samsung-s20fe").simulate(linear, illuminant="D65")
    cg2raw.write_dng(same, raw)
    assert out.read_bytes() == same.read_bytes()


def test_the_report(exr, tmp_path):
    out = tmp_path / "shot.dng"
    done = commands.run("convert", exr, "-o", out, *BASE, "--iso", 400)
    assert "66" in done.out
    assert "ISO 400, frame 0, 1 NaN values became 0, 1 inf" in done.out
    done = commands.run("convert", exr, "-o", out, *BASE, "--json")
    (file,) = json.loads(done.out)["files"]
    light = cg2raw.Sensor("samsung-s20fe").illuminant("D65")
    assert file["illuminant"]["neutral"] == list(light.neutral)
    assert (file["nan"], file["inf"], file["iso"]) == (1, 1, None)
    assert (file["width"], file["height"], file["method"]) == (98, 66, "graphics2raw")
    done = commands.run("convert", exr, "-o", out, *BASE, "--quiet")
    assert (done.code, done.out, done.err) == (0, "", "")


def test_several_inputs_need_a_folder_and_bad_ones_are_named(exr, tmp_path):
    names = ("a.exr", "b.exr", "c.exr")
    for name in names:
        shutil.copy(exr, tmp_path / name)
    (tmp_path / "b.exr").write_bytes(exr.read_bytes()[:4000])
    (tmp_path / "text.exr").write_text("no image")
    inputs = [tmp_path / name for name in (*names, "text.exr", "missing.exr")]
    out = tmp_path / "out"
    done = commands.run("convert", *inputs, "-o", out, *BASE)
    assert done.code == 1
    assert sorted(path.name for path in out.iterdir()) == ["a.dng", "c.dng"]
    said = done.err.splitlines()
    assert len(said) == 4 and said[-1] == "cg2raw convert: 3 of 5 failed"
    for name, line in zip(("b.exr", "text.exr", "missing.exr"), said, strict=False):
        assert name in line
    assert "No such file" in said[2]
    done = commands.run("convert", *inputs[:2], "-o", tmp_path / "two", *BASE)
    assert done.err.splitlines()[-1] == "cg2raw convert: 1 of 2 failed"
    line = commands.fails("convert", *inputs[:2], "-o", exr, *BASE)
    assert "is no folder" in line
    (tmp_path / "again").mkdir()
    shutil.copy(exr, tmp_path / "again" / "a.exr")
    twice = [inputs[0], tmp_path / "again" / "a.exr"]
    assert "would become" in commands.fails("convert", *twice, "-o", out, *BASE)


def test_a_new_folder_that_gets_no_file_is_not_left(tmp_path):
    inputs = [tmp_path / "missing.exr", tmp_path / "none.exr"]
    done = commands.run("convert", *inputs, "-o", tmp_path / "out", *BASE)
    assert done.code == 1 and not list(tmp_path.iterdir())


BAD = [
    (["--sensor", "nikon-d4", "--illuminant", "A"], 1, "nikon-d40"),
    (["--sensor", "nikon-d40"], 1, "--illuminant"),
    ([*BASE, "--frame", "1", "--frame-from", "name"], 1, "--frame-from name"),
    ([*BASE, "--layer", "sss"], 1, "--layer sss: no layer of that name"),
    (["--illuminant", "A"], 1, "--sensor"),
    ([*BASE, "--noise", "gaussian"], 1, "without --iso"),
    ([*BASE, "--noise", "upi"], 1, "--method upi"),
    ([*BASE, "--upi-gains", "camera"], 1, "--method upi"),
    ([*BASE, "--method", "upi"], 1, "--illuminant"),
    (["--method", "upi"], 1, "--method upi: needs --sensor, for CFA and levels"),
    ([*UPI, "--digital-gain", "sample"], 1, "--digital-gain"),
    ([*UPI, "--upi-sensors", "nikon-d4"], 1, "did you mean nikon-d40?"),
    ([*UPI, "--upi-sensors", "canon-5d,canon-5d"], 1, "--upi-sensors: canon-5d and"),
    ([*BASE, "--attrib", "dng:iso", "many"], 1, '--iso "many" must be an ISO'),
    ([*BASE, "--attrib", "dng:colour", "red"], 1, "--colour is unknown; known: --s"),
    ([*BASE, "--attrib", "dng:shadng", "baked"], 1, "did you mean --shading? known:"),
    ([*BASE, "--attrib", "iso", "800"], 1, "--attrib iso: its name must begin with"),
    ([*BASE, "--iso", "many"], 1, "from 1 to"),
    ([*BASE, "--digital-gain", "0"], 1, "0.001 to 1000"),
    ([*BASE, "--seed", "-1"], 1, "--seed"),
    ([*BASE, "--seed", str(2**64)], 1, "18446744073709551615"),
    ([*BASE, "--convention", "adobe"], 1, "paper"),
]


@pytest.mark.parametrize(("words", "code", "said"), BAD, ids=str)
def test_errors_are_one_line_and_leave_nothing(exr, tmp_path, words, code, said):
    out = tmp_path / "shot.dng"
    assert said in commands.fails("convert", exr, "-o", out, *words, code=code)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.exr"]


def test_other_primaries_and_spaces_are_refused(tmp_path, scene):
    wide = ("chromaticities", "float[8]", (0.7, 0.3, 0.2, 0.8, 0.1, 0.1, 0.31, 0.33))
    exr = write_image(tmp_path / "wide.exr", scene, typed=[wide])
    line = commands.fails("convert", exr, "-o", tmp_path / "x.dng", *BASE)
    assert "chromaticities" in line
    exr = write_image(tmp_path / "aces.exr", scene, {"oiio:ColorSpace": "ACEScg"})
    line = commands.fails("convert", exr, "-o", tmp_path / "x.dng", *BASE)
    assert "--tocolorspace" in line


@pytest.mark.parametrize("gain", [None, 0.5])
def test_method_upi_is_the_class_upi(exr, scene, tmp_path, gain):
    out, same = tmp_path / "shot.dng", tmp_path / "same.dng"
    words = [*UPI, "--seed", 3, "--noise", "upi"]
    words += ["--upi-sensors", "nikon-d40,canon-5d", "--upi-gains", "camera"]
    words += [] if gain is None else ["--digital-gain", gain]
    given = {} if gain is None else {"digital_gain": gain}
    done = commands.run("convert", exr, "-o", out, *words, "--json")
    assert done.code == 0, done.err
    matrices = ["nikon-d40", "canon-5d"]
    upi = cg2raw.Upi(
        "nikon-d40", matrices=matrices, gains="camera", noise="upi", **given
    )
    cg2raw.write_dng(same, upi.simulate(scene, seed=3), shot=read_image(exr).shot)
    assert out.read_bytes() == same.read_bytes()
    (file,) = json.loads(done.out)["files"]
    assert file["method"] == "upi"
    assert file["upi"]["red_gain"] == upi.draw(3).red_gain
    assert list(file["upi"]["weights"]) == ["nikon-d40", "canon-5d"]


EXPOSURE = {
    "meter": None, "stops": 0.0, "bracket": None, "scene_luminance": None,
    "exposure_time": 0.01, "f_number": 5.6,
}  # fmt: skip


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({}, []),
        ({"stops": -1.5, "meter": 0.2}, ["exposure -1.50"]),
        ({"meter": 0}, ["black: nothing to be metered, exposure 0"]),
        ({"stops": 1.0, "bracket": -2.0}, ["1/100 s", "exposure -1.00"]),
        (
            {"scene_luminance": 100.0, "stops": 1.0},
            ["1/100 s", "f/5.6", "exposure +1.00"],
        ),
        ({"scene_luminance": 100.0, "exposure_time": 2.5}, ["2.5 s", "f/5.6"]),
    ],
)
def test_what_is_said_of_an_exposure(known, words):
    assert exposure_words(EXPOSURE | known) == words


def test_workers_are_a_number_above_0():
    assert workers("3") == 3
    for text in ("0", "-1", "two"):
        with pytest.raises(argparse.ArgumentTypeError):
            workers(text)
