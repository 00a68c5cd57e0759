# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Commands of pages, run by a shell as they stand there, on small files of the names
that the pages speak of."""

import json
import os
import re
import subprocess
import sys

import jsonschema
import numpy as np
import OpenImageIO as oiio
import pytest
import rawpy
import tifffile

import cg2raw
from conftest import BUILD, OIIOTOOLS, ROOT, oiiotool_runner
from images import write_image

# An indented line that begins with the name of one of these, perhaps behind variables
# of the environment, and what continues it.
COMMAND = re.compile(
    r"^    ((?:[A-Z0-9_]+=\S+ (?:\\\n +)?)*"
    r"(?:cg2raw|oiiotool|exiftool|ln) (?:.*\\\n)*.*)$",
    re.MULTILINE,
)
CONFIG = BUILD / "share/cg2raw/ocio/sensors.ocio"
SCENE = (0.3, 0.2, 0.15)


def text_of(page):
    """Return the text of a page of docs/, or of the README."""
    return (ROOT / "docs" / page).read_text()


def environment_of(folder, oiiotool):
    """Return the variables of a shell in which the programs are this tree's."""
    tool, plugins = OIIOTOOLS[oiiotool]
    programs = folder / "programs"
    programs.mkdir()
    (programs / "oiiotool").symlink_to(tool)
    (programs / "cg2raw").write_text(
        f'#!/bin/sh\nexec {sys.executable} -m cg2raw "$@"\n'
    )
    (programs / "cg2raw").chmod(0o755)
    return {
        **os.environ,
        "PATH": f"{programs}:{os.environ['PATH']}",
        "PYTHONPATH": str(BUILD / "lib/python"),
        "OCIO": str(CONFIG),
        "OIIO_LIBRARY_PATH": str(plugins),
        "OPENIMAGEIO_PLUGIN_PATH": str(plugins),
        "CG2RAW_PROFILE_PATH": str(ROOT / "plugins/profiles"),
    }


def run_commands(page, folder, oiiotool="oiio-system", apart=()):
    """Run the commands of a page in a folder; none may fail. Return how many.

    apart : of words; a command that has one of them is not run."""
    environment = environment_of(folder, oiiotool)
    commands = COMMAND.findall(text_of(page))
    assert all(any(word in command for command in commands) for word in apart)
    commands = [c for c in commands if not any(word in c for word in apart)]
    for command in commands:
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, command + "\n" + done.stdout + done.stderr
    return len(commands)


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


@pytest.mark.parametrize("tool", OIIOTOOLS)
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
    oiiotool_runner("oiio-system")  # skips what is not there
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


def written_config(path):
    """Write a config of a studio: one that OpenColorIO brings along."""
    ocio = pytest.importorskip("PyOpenColorIO", minversion="2.5")
    name = "cg-config-v2.1.0_aces-v1.3_ocio-v2.3"
    path.write_text(ocio.Config.CreateFromBuiltinConfig(name).serialize())


# Tested by their own pages, on captures and renders that are like a camera's.
OF_OTHER_PAGES = ("cg2raw dataset", "cg2raw calibrate", "cg2raw diagnose")


@pytest.mark.parametrize("tool", OIIOTOOLS)
def test_readme(tmp_path, render, tool):
    """All of its commands but those that build."""
    oiiotool_runner(tool)  # skips what is not there
    written_config(tmp_path / "studio.ocio")
    for number in range(3):
        os.link(tmp_path / "shot.exr", tmp_path / f"shot.{number}.exr")
        raw = cg2raw.Sensor("nikon-d40").simulate(
            render, illuminant=("A", "D50", "D65")[number]
        )
        cg2raw.write_dng(tmp_path / f"IMG_{number}.dng", raw)
    apart = (*OF_OTHER_PAGES, "doctor")
    assert run_commands("../README.md", tmp_path, tool, apart) >= 12
    assert len(list((tmp_path / "looks").iterdir())) == 3
    assert cg2raw.Sensor(tmp_path / "my-camera.json").model == "NIKON D40"


@pytest.mark.slow
@pytest.mark.parametrize("tool", OIIOTOOLS)
def test_ocio(tmp_path, render, tool):
    """Configs of all sensors under a hundred lights are among what it makes."""
    oiiotool_runner(tool)  # skips what is not there
    written_config(tmp_path / "studio.ocio")
    assert run_commands("ocio.md", tmp_path, tool) == 9


@pytest.mark.parametrize("tool", OIIOTOOLS)
def test_compositors(tmp_path, render, tool):
    """But for Blender's own config, which tests/ocio/test_blender.py merges."""
    oiiotool_runner(tool)  # skips what is not there
    os.link(tmp_path / "shot.exr", tmp_path / "render.exr")
    apart = ("colormanagement_raw",)
    assert run_commands("compositors.md", tmp_path, tool, apart) == 7
