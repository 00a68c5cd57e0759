# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A DNG by way of OCIO is the DNG that the plugin converts by itself."""

import json

import numpy as np
import pytest

from cg2raw import _core
from cg2raw.cli import main
from cg2raw_ocio.config import config_text, make_config
from images import attributes, read_dn
from tiers import WHEEL_FAST, first_fast

# Bits of a sensor, and the share of words that may differ by 1.
SHARES = {10: 0.0005, 12: 0.001, 14: 0.003}
SENSORS = {"samsung-s20fe": 10, "nikon-d40": 12, "canon-600d": 14}
RUNS = [
    ("samsung-s20fe", "2856K", "interior"),
    ("nikon-d40", "D65", "night_street"),
    ("canon-600d", "sample:1", "interior"),
]

COLOR_MATRIX = {"rg": 0.1, "rb": 0.0, "gr": -0.05, "gb": 0.05, "br": 0.0, "bg": 0.08}
FALL_OFF = dict.fromkeys(("r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2"), 0)
FALL_OFF["r2"] = -0.3


EXACT = ["--compression", "zip"]


def decoded(oiiotool, repository, folder, picture, *words):
    """Return a picture decoded once, for all routes: OpenEXR decodes DWA by functions
    that round otherwise, now and then, in the first rows of a process."""
    path = folder / f"{picture}.exr"
    oiiotool(repository / "tests" / "data" / path.name, *words, *EXACT, "-o", path)
    return path


def check(oiiotool, repository, folder, sensor, light, picture):
    """Write a picture by both routes and compare the words."""
    scene = decoded(oiiotool, repository, folder, picture)
    path = folder / "config.ocio"
    path.write_text(config_text(make_config([_core.load_profile(sensor)], [light])))
    by_ocio, direct = folder / "ocio.dng", folder / "direct.dng"
    env = {"OCIO": str(path)}
    space = f"RAW - {sensor} - {light}"
    oiiotool(scene, "--tocolorspace", space, "-o", by_ocio, env=env)
    given = attributes(sensor=sensor, illuminant=light)
    oiiotool(scene, *given, "-o", direct, env=env)
    difference = np.abs(read_dn(by_ocio).astype(int) - read_dn(direct))
    bits = SENSORS[sensor]
    share = (difference > 0).mean()
    print(f"{oiiotool.name} {sensor} {light} {picture}: {share:.4%}")
    assert difference.max() <= 1
    assert share <= SHARES[bits]


@pytest.mark.parametrize(("sensor", "light", "picture"), first_fast(RUNS, 1))
@pytest.mark.parametrize("oiiotool", WHEEL_FAST, indirect=True)
def test_both_routes(oiiotool, repository, tmp_path, sensor, light, picture):
    check(oiiotool, repository, tmp_path, sensor, light, picture)


@pytest.mark.slow
@pytest.mark.parametrize("picture", ["interior", "night_street"])
@pytest.mark.parametrize("light", ["A", "D65", "9000K", "2000K"])
@pytest.mark.parametrize("sensor", SENSORS)
def test_both_routes_in_depth(oiiotool, repository, tmp_path, sensor, light, picture):
    check(oiiotool, repository, tmp_path, sensor, light, picture)


@pytest.fixture
def departed(repository, tmp_path):
    """Return a profile (.json) with colour effects, one before the mosaic, and noise
    that does not hide them."""
    effects = [
        {"name": "exposure", "parameters": {"gain": -0.2}},
        {"name": "white_balance", "parameters": {"red": 0.1, "blue": -0.15}},
        {"name": "color_matrix", "parameters": COLOR_MATRIX},
        {"name": "lens_shading", "parameters": FALL_OFF},
    ]
    text = (repository / "plugins/profiles/nikon-d40.json").read_text()
    fields = json.loads(text) | {"id": "departed", "effects": effects}
    path = tmp_path / "departed.json"
    path.write_text(json.dumps(fields))
    return path


@pytest.mark.parametrize("oiiotool", WHEEL_FAST, indirect=True)
def test_color_effects_are_not_applied_twice(oiiotool, repository, tmp_path, departed):
    """By the plugin and by cg2raw convert, of pixels in the sensor's RAW space."""
    half = ("--cut", "320x240+160+120")
    scene = decoded(oiiotool, repository, tmp_path, "interior", *half)
    config = tmp_path / "config.ocio"
    profile = _core.load_profile(str(departed))
    config.write_text(config_text(make_config([profile], ["D65"])))
    raw, direct, by_ocio, converted = (
        tmp_path / name for name in ("raw.exr", "direct.dng", "ocio.dng", "convert.dng")
    )
    space, env = "RAW - departed - D65", {"OCIO": str(config)}
    to_space = ["--tocolorspace", space]
    oiiotool(scene, *to_space, "-d", "float", *EXACT, "-o", raw, env=env)
    given = attributes(sensor=departed)
    oiiotool(raw, "--iscolorspace", space, *given, "-o", by_ocio, env=env)
    oiiotool(scene, *given, *attributes(illuminant="D65"), "-o", direct)
    convert = ["convert", raw, "--sensor", departed, "--iscolorspace", space]
    assert main([*map(str, convert), "--quiet", "-o", str(converted)]) == 0
    expected = read_dn(direct).astype(int)
    for path in (by_ocio, converted):
        difference = np.abs(read_dn(path) - expected)
        assert difference.max() <= 1
        assert (difference > 0).mean() <= SHARES[12]
    plain = tmp_path / "plain.dng"
    oiiotool(scene, *given, *attributes(illuminant="D65", effects="none"), "-o", plain)
    assert np.abs(read_dn(plain) - expected).max() > 300


def test_color_effects_of_a_raw_space_cannot_be_left_out(
    oiiotool, repository, tmp_path, departed
):
    scene = repository / "tests" / "data" / "interior.exr"
    out = tmp_path / "out.dng"
    space = ["--iscolorspace", "RAW - departed - D65"]
    given = attributes(sensor=departed, effects="none")
    done = oiiotool(scene, *space, *given, "-o", out, check=False)
    assert done.returncode != 0 and not out.exists()
    assert "RAW space, which has effect exposure in it" in done.stdout + done.stderr


def test_the_sensors_have_the_bits_of_the_table(repository):
    for sensor, bits in SENSORS.items():
        path = repository / "plugins" / "profiles" / f"{sensor}.json"
        assert _core.load_profile(str(path)).bits == bits
