# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Commands of pages, run by a shell as they stand there, on small files of the names
that the pages use."""

import json
import os
import re
import subprocess

import jsonschema
import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy
import tifffile

import cg2raw
from conftest import OIIOTOOLS, oiiotool_runner
from images import write_image
from pages import run_commands, text_of, write_studio_config
from tiers import WHEEL_FAST

SCENE = (0.3, 0.2, 0.15)


@pytest.fixture
def render(tmp_path):
    """Return the pixels of the shot.exr that pages speak of: one colour."""
    pixels = np.full((64, 96, 3), SCENE, np.float32)
    write_image(tmp_path / "shot.exr", pixels)
    return pixels


def words_of(path):
    """Return the stored DN of a DNG."""
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image.copy()


@pytest.mark.parametrize("tool", WHEEL_FAST)
def test_oiiotool(tmp_path, render, tool):
    oiiotool_runner(tool)  # skips what is not there
    raw = cg2raw.Sensor("samsung-s20fe").simulate(
        render, illuminant="2856K", iso=3200, seed=7
    )
    assert run_commands("oiiotool.md", tmp_path, tool) == 6
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "mosaic.tif"), raw)
    picture = oiio.ImageBuf(str(tmp_path / "shot.exr"))
    assert picture.spec().format == oiio.FLOAT and picture.nchannels == 3
    np.testing.assert_allclose(picture.get_pixels().mean(axis=(0, 1)), SCENE, rtol=0.01)
    other = cg2raw.read_dng_metadata(str(tmp_path / "other.dng"))
    assert other.model == cg2raw.Sensor("nikon-d40").model


def test_provenance(tmp_path, render, program):
    exiftool = program("exiftool")
    raw = cg2raw.Sensor("gopro-hero6-black").simulate(render, illuminant="D50")
    cg2raw.write_dng(tmp_path / "shot.dng", raw)
    tifffile.imwrite(tmp_path / "developed.tif", np.zeros((8, 8, 3), np.uint8))
    assert run_commands("provenance.md", tmp_path) == 2
    for name in ("shot.dng", "developed.tif"):
        words = [exiftool, "-j", "-n", "-XMP:all", tmp_path / name]
        done = subprocess.run(words, capture_output=True, check=True)
        (said,) = json.loads(done.stdout)
        assert said["DigitalSourceType"].endswith("/compositeSynthetic")
        assert said["Sensor"] == "gopro-hero6-black"
    np.testing.assert_array_equal(words_of(tmp_path / "shot.dng"), raw)


def test_profile(tmp_path):
    """Its command, and the profile that it shows."""
    assert run_commands("profile.md", tmp_path) == 1
    schema = json.loads((tmp_path / "cg2raw-profile.schema.json").read_text())
    (shown,) = re.findall(r"```json\n(.*?)```", text_of("profile.md"), re.DOTALL)
    jsonschema.validate(json.loads(shown), schema)
    (tmp_path / "my-camera.json").write_text(shown)
    sensor = cg2raw.Sensor(tmp_path / "my-camera.json")
    grey = np.full((8, 8, 3), 0.18, np.float32)
    assert sensor.simulate(grey, illuminant="D65", iso=100).min() > 512


def test_illuminants(tmp_path, render):
    camera = cg2raw.Sensor("nikon-d40")
    (tmp_path / "captures").mkdir()
    for number, light in enumerate(("A", "3400K", "D50", "D65", "7500K")):
        raw = camera.simulate(render, illuminant=light)
        cg2raw.write_dng(tmp_path / f"captures/{number}.dng", raw)
    assert run_commands("illuminants.md", tmp_path) == 2
    mine = cg2raw.Sensor(tmp_path / "my-camera.json")
    neutral = cg2raw.read_dng_metadata(str(tmp_path / "shot.dng")).as_shot_neutral
    expected = mine.illuminant("measured:7").neutral
    np.testing.assert_allclose(neutral, expected, atol=1e-5)


def test_monochrome(tmp_path, render):
    """Its profile; the last command and the line of Python make one RAW."""
    oiiotool_runner("oiio-wheel")  # skips what is not there
    page = text_of("monochrome.md")
    (shown,) = re.findall(r"```json\n(.*?)```", page, re.DOTALL)
    (tmp_path / "my-mono.json").write_text(shown)
    assert run_commands("monochrome.md", tmp_path) == 2
    (line,) = re.findall(r"^    (raw = .*)$", page, re.MULTILINE)
    names = {"cg2raw": cg2raw, "rgb": render}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        exec(line, names)
    np.testing.assert_array_equal(words_of(tmp_path / "shot.dng"), names["raw"])


def test_upi(tmp_path, render):
    """Its command, and its lines of Python, which draw the same camera."""
    assert run_commands("upi.md", tmp_path) == 1
    (block,) = re.findall(r"(?:^    \w+ = .*\n)+", text_of("upi.md"), re.MULTILINE)
    names = {"cg2raw": cg2raw, "rgb": render}
    exec(re.sub("^    ", "", block, flags=re.MULTILINE), names)
    np.testing.assert_array_equal(words_of(tmp_path / "shot.dng"), names["raw"])


@pytest.mark.slow
@pytest.mark.parametrize("tool", OIIOTOOLS)
def test_ocio(tmp_path, render, tool):
    """Configs of all sensors under a hundred lights are among what it makes."""
    oiiotool_runner(tool)  # skips what is not there
    write_studio_config(tmp_path / "studio.ocio")
    assert run_commands("ocio.md", tmp_path, tool) == 9


@pytest.mark.parametrize("tool", WHEEL_FAST)
def test_compositors(tmp_path, render, tool):
    """But for Blender's own config, which tests/ocio/test_blender.py merges."""
    oiiotool_runner(tool)  # skips what is not there
    os.link(tmp_path / "shot.exr", tmp_path / "render.exr")
    apart = ("colormanagement_raw",)
    assert run_commands("compositors.md", tmp_path, tool, apart) == 7
