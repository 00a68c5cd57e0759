# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Blender with a generated config: menus, files in a RAW space, the example.

Run with --slow, where Blender 5 is: CG2RAW_BLENDER_PYTHON names a Python that can
import bpy; else this Python, if it can; else the blender on PATH."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw_ocio import config as generator
from cg2raw_ocio.names import SCENE_LINEAR
from images import read_dn, write_image
from python.commands import run

pytestmark = pytest.mark.slow

ROUTES = Path(__file__).with_name("blender_routes.py")
SENSOR, LIGHT = "nikon-d40", "D65"
SPACE = f"RAW - {SENSOR} - {LIGHT}"
TOLERANCE = 0.25 / 65535


def blender_command():
    """Return what a script's path is to follow, or None without Blender."""
    named = os.environ.get("CG2RAW_BLENDER_PYTHON")
    for python in (named,) if named else (sys.executable,):
        found = subprocess.run([python, "-c", "import bpy"], capture_output=True)
        if found.returncode == 0:
            return [python]
    if named:
        pytest.fail(f"CG2RAW_BLENDER_PYTHON: {named} cannot import bpy")
    program = shutil.which("blender")
    return program and [program, "-b", "--factory-startup", "-P"]


@pytest.fixture(scope="module")
def blender():
    """Return run(script, *arguments, OCIO=..., ...) -> (JSON or None, all output)."""
    command = blender_command()
    if not command:
        pytest.skip("no Blender: CG2RAW_BLENDER_PYTHON names a Python with bpy")

    def run(script, *arguments, **environment):
        dashes = ["--"] if len(command) > 1 else []
        clean = {k: v for k, v in os.environ.items() if k not in ("OCIO", "PYTHONPATH")}
        done = subprocess.run(
            [*command, script, *dashes, *map(str, arguments)],
            env={**clean, **environment},
            text=True,
            capture_output=True,
        )
        output = done.stdout + done.stderr
        assert done.returncode == 0, output
        lines = [x for x in done.stdout.splitlines() if x.startswith("JSON ")]
        return (json.loads(lines[-1][5:]) if lines else None), output

    return run


@pytest.fixture(scope="module")
def config(repository, tmp_path_factory):
    """Return (path, config) of two sensors under two lights."""
    folder = repository / "plugins" / "profiles"
    profiles = [
        cg2raw._core.load_profile(str(folder / f"{name}.json"))
        for name in (SENSOR, "samsung-s20fe")
    ]
    made = generator.make_config(profiles, [LIGHT, "2856K"])
    path = tmp_path_factory.mktemp("config") / "sensors.ocio"
    path.write_text(generator.config_text(made))
    return path, made


@pytest.fixture(scope="module")
def scene():
    """Return (48, 64, 3): the unit cube, 16 stops, highlights, and negative values."""
    random = np.random.default_rng(7)
    rows = [
        random.uniform(0.0, 1.0, (12, 64, 3)),
        2.0 ** random.uniform(-12, 4, (12, 64, 3)),
        random.uniform(0.8, 1.2, (12, 64, 3)),
        random.uniform(-0.3, 1.2, (12, 64, 3)),
    ]
    return np.concatenate(rows).astype(np.float32)


@pytest.fixture(scope="module")
def routes(blender, config, scene, tmp_path_factory):
    """Return the folder of what Blender wrote along each route."""
    folder = tmp_path_factory.mktemp("routes")
    write_image(folder / "scene.exr", scene)
    blender(ROUTES, "routes", folder, SPACE, OCIO=str(config[0]))
    return folder


def converted(config, source, target, pixels):
    """Return @pixels as OpenColorIO's CPU converts them."""
    processor = config.getProcessor(source, target).getDefaultCPUProcessor()
    rgba = np.concatenate([pixels, np.ones_like(pixels[..., :1])], -1)
    processor.applyRGBA(rgba)
    return rgba[..., :3]


def read_image(path):
    """Return ((H, W, C) float32, spec) of an image file."""
    image = oiio.ImageBuf(str(path))
    assert not image.has_error, image.geterror()
    return image.get_pixels("float"), image.spec()


def test_blender_takes_the_config(blender, config, tmp_path):
    path, made = config
    found, output = blender(ROUTES, "spaces", tmp_path, OCIO=str(path))
    assert f"Using OCIO={path}" in output
    assert "ERROR" not in output
    active = set(made.getColorSpaceNames())
    assert SPACE in active
    assert active <= set(found["menu"])
    assert not [name for name in found["menu"] if name.startswith("RAW unbounded")]
    assert found["working"] == "lin_rec709_scene"
    assert found["float"] == SCENE_LINEAR
    assert found["byte"] == "sRGB Encoded Rec.709 (sRGB)"
    assert found["data"] == ["Non-Color", True]
    assert found["view"] == generator.DEVELOPED_VIEW


@pytest.mark.parametrize(
    "route", ["output_override", "file_output_node", "convert_node", "save_render"]
)
def test_a_file_in_a_raw_space(routes, config, scene, route):
    pixels, spec = read_image(routes / f"{route}.exr")
    assert spec.format == "float"
    expected = converted(config[1], SCENE_LINEAR, SPACE, scene)
    assert np.ptp(expected) > 0.9
    np.testing.assert_allclose(pixels, expected, rtol=0, atol=TOLERANCE)
    # After a Convert Colorspace node Blender still labels the file scene linear.
    wrong_label = spec.get_string_attribute("colorInteropID") == "lin_rec709_scene"
    assert wrong_label == (route == "convert_node")


def test_an_image_in_a_raw_space(routes, config, scene):
    pixels, _ = read_image(routes / "read_raw.exr")
    expected = converted(config[1], SPACE, SCENE_LINEAR, scene)
    np.testing.assert_allclose(pixels, expected, rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize("route", ["output_override", "convert_node"])
def test_the_dng_of_such_a_file(oiiotool, routes, config, tmp_path, route):
    environment = {"OCIO": str(config[0])}
    out, direct = tmp_path / "blender.dng", tmp_path / "direct.dng"
    source = routes / f"{route}.exr"
    oiiotool(source, "--iscolorspace", SPACE, "-o", out, env=environment)
    convert = ["--colorconvert", SCENE_LINEAR, SPACE]
    oiiotool(routes / "scene.exr", *convert, "-o", direct, env=environment)
    difference = np.abs(read_dn(out).astype(int) - read_dn(direct))
    assert read_dn(out).max() > 1000
    assert difference.max() <= 1


def test_a_file_made_with_blenders_own_config(blender, config, tmp_path):
    blender(ROUTES, "save_blend", tmp_path)
    found, output = blender(ROUTES, "open_blend", tmp_path, OCIO=str(config[0]))
    assert found == {
        "Non-Color": "Non-Color",
        "sRGB": "sRGB Encoded Rec.709 (sRGB)",
        "Linear Rec.709": SCENE_LINEAR,
        "ACEScg": "ACEScg",
        "ACES2065-1": "ACES2065-1",
    }
    assert "image colorspace" not in output, output


def test_the_example(blender, config, repository, build_folder, tmp_path):
    plugins = build_folder / "lib/cg2raw/oiio"
    if not Path("/usr/bin/oiiotool").exists() or not plugins.is_dir():
        pytest.skip(f"no /usr/bin/oiiotool with {plugins}")
    profiles = repository / "plugins" / "profiles"
    dng = tmp_path / "shot.dng"
    blender(
        repository / "ocio" / "examples" / "blender_raw.py",
        *(dng, SENSOR, LIGHT, 160, 4),
        OCIO=str(config[0]),
        PATH=f"/usr/bin:{os.environ['PATH']}",
        OIIO_LIBRARY_PATH=str(plugins),
        CG2RAW_PROFILE_PATH=str(profiles),
    )
    assert read_dn(dng).shape == (120, 160)
    # The grey floor under white light has the colour of the light.
    floor = read_image(dng.with_suffix(".exr"))[0][110:, 60:100].mean((0, 1))
    sensor = cg2raw._core.load_profile(str(profiles / f"{SENSOR}.json"))
    neutral = np.array(sensor.illuminant(LIGHT).neutral)
    np.testing.assert_allclose(floor / floor[1], neutral / neutral[1], atol=0.01)


def test_blenders_own_config_keeps_agx_and_gains_raw_spaces(blender, tmp_path):
    """The how-to of docs/compositors.md: RAW spaces in a copy of Blender's folder."""
    script = Path(__file__).with_name("blender_own_config.py")
    found, _ = blender(script, "folder")
    folder = tmp_path / "colormanagement_raw"
    shutil.copytree(found["folder"], folder)
    done = run(
        "ocio", "--sensors", f"{SENSOR},samsung-s20fe", "--illuminants", "A,D65",
        "--merge", folder / "config.ocio", "-o", folder / "raw.ocio",
    )  # fmt: skip
    assert done.code == 0 and done.err == "" and "version 2.4" in done.out
    pixels = np.random.default_rng(1).uniform(0, 1.2, (4, 4, 3)).astype(np.float32)
    np.save(tmp_path / "pixels.npy", pixels)
    blender(script, "look", tmp_path / "own.png", tmp_path / "pixels.npy")
    ours = {"OCIO": str(folder / "raw.ocio")}
    names = (tmp_path / "agx.png", tmp_path / "pixels.npy", tmp_path / "raw.exr", SPACE)
    said, _ = blender(script, "look", *names, **ours)
    assert said["view"] == "AgX"
    own, agx, raw = (
        oiio.ImageBuf(str(tmp_path / name)).get_pixels(oiio.FLOAT)
        for name in ("own.png", "agx.png", "raw.exr")
    )
    np.testing.assert_array_equal(own, agx)
    camera = cg2raw.Sensor(SENSOR).to_camera(pixels, illuminant=LIGHT)
    assert np.abs(raw[..., :3] - camera).max() < TOLERANCE
