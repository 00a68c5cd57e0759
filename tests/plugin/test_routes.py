# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Both ways into the plugin: scene-linear with dng:sensor, and pixels that are RAW."""

import numpy as np
import pytest

import cg2raw
from images import attributes, read_dn, write_image

S20 = attributes(sensor="samsung-s20fe", illuminant="2856K")
RUNS = {
    "clean": {},
    "noisy": {"iso": 1600, "seed": 7},
    "frame": {"iso": 400, "seed": 7, "frame": 3},
    "paper": {"convention": "paper"},
    "no-highlights": {"highlights": False},
    "gain": {"digital_gain": 0.75},
    "no-effects": {"iso": 800, "effects": False},
    "stops": {"exposure": -1.5},
    "drawn": {"exposure": "random:-1:2", "seed": 7, "frame": 3},
    "metered": {"exposure": "auto", "iso": 400},
    "settings": {
        "scene_luminance": 50,
        "exposure_time": 0.02,
        "f_number": 2,
        "iso": 400,
    },
    "found": {"exposure": "auto", "scene_luminance": 900, "f_number": 2, "iso": 100},
    "bracket": {"bracket": -2, "exposure_time": 0.02, "iso": 800},
}
WORDS = {False: "0"}


def arguments_of(run):
    """Return the oiiotool arguments of keyword arguments of Sensor.simulate."""
    words = {WORDS.get(name, name): WORDS.get(v, v) for name, v in run.items()}
    if "effects" in words:
        words["effects"] = "none"
    return attributes(**words)


@pytest.mark.parametrize("name", RUNS)
def test_direct_route_writes_what_the_core_simulates(
    oiiotool, exr, scene, tmp_path, name
):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, *arguments_of(RUNS[name]), "-o", out)
    sensor = cg2raw.Sensor("samsung-s20fe")
    raw = sensor.simulate(scene, illuminant="2856K", **RUNS[name])
    np.testing.assert_array_equal(read_dn(out), raw)


@pytest.mark.parametrize(
    "space",
    ["RAW - nikon-d40 - 2856K", "raw_nikon_d40_2856k", "RAW - NIKON-D40 - 2856k"],
)
def test_pixels_that_are_raw_are_only_mosaiced(oiiotool, tmp_path, scene, space):
    sensor = cg2raw.Sensor("nikon-d40")
    camera = sensor.to_camera(scene, illuminant="2856K")
    exr = write_image(tmp_path / "camera.exr", camera)
    out = tmp_path / "shot.dng"
    oiiotool(exr, "--iscolorspace", space, "-o", out)
    expected = sensor.simulate(scene, illuminant="2856K")
    np.testing.assert_array_equal(read_dn(out), expected)


def test_raw_route_knows_a_sensor_given_by_path(oiiotool, tmp_path, scene, repository):
    text = (repository / "plugins/profiles/nikon-d40.json").read_text()
    profile = tmp_path / "mine.json"
    profile.write_text(text.replace('"id": "nikon-d40"', '"id": "mine"'))
    exr = write_image(tmp_path / "camera.exr", scene)
    out = tmp_path / "shot.dng"
    space = ["--iscolorspace", "RAW - mine - D65"]
    oiiotool(exr, *space, *attributes(sensor=profile), "-o", out)
    assert read_dn(out).shape == (96, 128)


def test_the_remedy_for_a_display_referred_image_works(oiiotool, tmp_path, scene):
    png = write_image(tmp_path / "display.png", np.clip(scene, 0, 1))
    out = tmp_path / "shot.dng"
    done = oiiotool(png, *S20, "-o", out, check=False)
    assert done.returncode != 0
    oiiotool(png, "--tocolorspace", "linear", *S20, "-o", out)
    assert read_dn(out).shape == (96, 128)


def test_both_oiiotools_write_the_same_bytes(exr, tmp_path):
    from conftest import oiiotool_runner

    written = []
    for name in ("oiio-system", "oiio-wheel"):
        out = tmp_path / f"{name}.dng"
        run = oiiotool_runner(name)
        run(exr, *S20, *attributes(iso=3200, seed=3), "-o", out)
        written.append(out.read_bytes())
    assert written[0] == written[1]


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_threads_do_not_change_the_bytes(oiiotool, exr, tmp_path, threads):
    outs = [tmp_path / "one.dng", tmp_path / "many.dng"]
    for out, count in zip(outs, (1, threads), strict=True):
        arguments = attributes(iso=3200, seed=3)
        oiiotool("--threads", count, exr, *S20, *arguments, "-o", out)
    assert outs[0].read_bytes() == outs[1].read_bytes()
