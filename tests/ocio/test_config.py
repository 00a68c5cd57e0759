# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Configs: valid, without warnings, archivable, and named as the plugin reads names."""

import os
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import OpenImageIO as oiio
import PyOpenColorIO as ocio
import pytest

import cg2raw
from cg2raw import _core
from cg2raw_ocio import names
from cg2raw_ocio.config import VERSIONS, config_text, make_config
from cg2raw_ocio.spaces import Exposure
from conftest import OIIOTOOLS, ROOT
from images import write_image
from ocio.pixels import kinds_of_pixels
from oracles import camera_transform, cameras
from tiers import WHEEL_FAST

CHECKERS = {
    "system": Path("/usr/bin/ociocheck"),
    "wheel": ROOT / ".venv" / "bin" / "ociocheck",
}
WORDS = (
    "A D50 D65 3200K 3200.5K xy:0.3457:0.3585 neutral:0.55:0.45 neutral:1.25:0.333333"
    " neutral:1:0.5 sample:1 sample:12"
).split()
MAX_DN, MEAN_DN = 0.25 / 65535.0, 0.01 / 65535.0


@pytest.fixture(scope="module")
def config(profiles):
    """Return a config of six sensors under three lights."""
    return make_config(profiles[::3], ["A", "D65", "sample:1"])


@pytest.mark.parametrize("checker", CHECKERS)
@pytest.mark.parametrize("version", VERSIONS)
def test_ociocheck_has_no_warning(profiles, tmp_path, checker, version):
    if not CHECKERS[checker].exists():
        pytest.skip(f"no {CHECKERS[checker]}")
    path = tmp_path / "config.ocio"
    path.write_text(config_text(make_config(profiles[:2], WORDS, version=version)))
    command = [CHECKERS[checker], "--iconfig", path]
    done = subprocess.run(command, capture_output=True, text=True)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "passed" in said
    assert re.findall(r"(?m)^(?:WARNING|ERROR|Warnings encountered).*", said) == []


def test_text_is_that_of_the_config(config):
    again = ocio.Config.CreateFromStream(config_text(config))
    again.validate()
    assert again.serialize() == config.serialize()
    assert again.getInactiveColorSpaces() == config.getInactiveColorSpaces() != ""


def test_the_same_config_has_the_same_text(profiles):
    texts = {config_text(make_config(profiles[:2], ["A", "D65"])) for _ in range(2)}
    assert len(texts) == 1


def test_a_config_that_cannot_be_is_refused():
    sensor = cg2raw.Sensor("nikon-d40")
    grey = cg2raw.Sensor.from_json(cameras.mono_text(id="grey")).profile
    for sensors, lights, options, words in (
        ([grey], ["D65"], {}, "sensor grey is monochrome and has no RAW colour space"),
        ([sensor.profile], ["A", "A"], {}, "'RAW - nikon-d40 - A' is asked for twice"),
        (
            [sensor.profile],
            ["A"],
            {"exposure": Exposure("sensor")},
            "convention sensor has no RAW space of its own",
        ),
        ([sensor.profile], ["A"], {"version": "2.2"}, "version '2.2' must be 2.0 or"),
    ):
        with pytest.raises(ValueError, match=words):
            make_config(sensors, lights, **options)


@pytest.mark.parametrize(
    ("make", "family"),
    [
        ("NIKON CORPORATION", "RAW/Nikon"),
        ("samsung", "RAW/Samsung"),
        ("OmniVision Inc.", "RAW/OmniVision"),
        ("a/b c", "RAW/A b"),  # no family of its own
        ("", "RAW/Other"),
    ],
)
def test_a_family_is_the_make_as_people_say_it(make, family):
    assert names.family(SimpleNamespace(make=make)) == family


def test_archive(config, tmp_path):
    path = tmp_path / "config.ocio"
    path.write_text(config_text(config))
    archive = tmp_path / "config.ocioz"
    loaded = ocio.Config.CreateFromFile(str(path))
    assert loaded.isArchivable()
    loaded.archive(str(archive))
    again = ocio.Config.CreateFromFile(str(archive))
    again.validate()
    assert again.serialize() == loaded.serialize()
    assert sorted(again.getColorSpaceNames()) == sorted(config.getColorSpaceNames())


def test_every_name_is_understood_by_the_plugin(profiles):
    for profile in profiles:
        for word in WORDS:
            told = [
                name
                for of in (names.raw_space, names.unbounded_space)
                for name in of(profile.id, word)
            ]
            # Name, alias and interop ID of the space, and of its unbounded twin.
            assert len({name.lower() for name in told}) == 6
            for name in told:
                sensor, light = cg2raw.raw_space_from_name(name)
                assert sensor == profile.id, name
                same = profile.illuminant(word)
                assert profile.illuminant(light).neutral == same.neutral, name


def test_no_two_spaces_share_a_name(profiles):
    made = make_config(profiles, WORDS)
    everything = (ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL)
    spaces = list(made.getColorSpaces(*everything))
    told = [n.lower() for s in spaces for n in (s.getName(), *s.getAliases())]
    assert len(told) == len(set(told))
    raw = [s for s in spaces if s.getFamily().startswith("RAW/")]
    assert len(raw) == 2 * len(profiles) * len(WORDS)
    for space in raw:
        assert space.getEncoding() == "scene-linear"
        assert list(space.getCategories()) == ["file-io"]
        assert space.getDescription()


@pytest.mark.parametrize("space", ["RAW - {} - {}", "RAW unbounded - {} - {}"])
def test_looked_at_white_balanced_a_raw_is_the_scene(config, profiles, space):
    rgb = np.random.default_rng(6).uniform(0.2, 0.5, (200, 3)).astype(np.float32)
    name = space.format(profiles[3].id, "A")
    linear = names.SCENE_LINEAR

    def applied(source, pixels, *to):
        out = pixels.copy()
        config.getProcessor(source, *to).getDefaultCPUProcessor().applyRGB(out)
        return out

    camera = applied(linear, rgb, name)
    seen, expected = (
        applied(
            source,
            pixels,
            "sRGB - Display",
            "White balanced",
            ocio.TRANSFORM_DIR_FORWARD,
        )
        for source, pixels in ((name, camera), (linear, rgb))
    )
    assert np.abs(camera - rgb).max() > 0.05
    assert np.abs(seen - expected).max() <= 2e-5


def check_oiiotool(tool, profiles, lights, exposure, folder, count):
    """Compare all RAW spaces of a config, as one oiiotool converts to them, with
    float64."""
    path = folder / "config.ocio"
    path.write_text(config_text(make_config(profiles, lights, exposure)))
    rgb = np.concatenate(list(kinds_of_pixels(count).values()))[None]
    source = write_image(folder / "scene.exr", rgb)
    command = [tool, source, "--iscolorspace", names.SCENE_LINEAR]
    asked = [(profile, light) for profile in profiles for light in lights]
    for number, (profile, light) in enumerate(asked):
        space = names.raw_space(profile.id, light)[number % 2]
        out = ["-d", "float", "-o", folder / f"{number}.exr", "--pop"]
        command += ["--dup", "--tocolorspace", space, *out]
    environment = {**os.environ, "OCIO": str(path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    for number, (profile, light) in enumerate(asked):
        transform = _core.camera_from_scene(
            profile,
            profile.illuminant(light),
            exposure.convention,
            exposure.digital_gain,
            exposure.highlights,
        )
        camera = oiio.ImageBuf(str(folder / f"{number}.exr")).get_pixels(oiio.FLOAT)
        error = np.abs(camera - camera_transform.camera_from_scene(rgb, transform))
        assert error.max() <= MAX_DN, (profile.id, light)
        assert error.mean() <= MEAN_DN, (profile.id, light)


def tool_of(name):
    tool = OIIOTOOLS[name][0]
    if not tool.exists():
        pytest.skip(f"no {tool}")
    return tool


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("name", WHEEL_FAST)
def test_oiiotool(profiles, tmp_path, name, convention):
    exposure = Exposure(convention, 0.9)
    lights = ["A", "D65", "2000K", "9000K", "sample:1"]
    check_oiiotool(tool_of(name), profiles[::6], lights, exposure, tmp_path, 1500)


@pytest.mark.slow
@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("gain", [0.6, 1.0, 1.2])
@pytest.mark.parametrize("name", OIIOTOOLS)
def test_oiiotool_in_depth(profiles, tmp_path, name, convention, gain):
    lights = ["A", "D50", "D65", "2000K", "9000K", "sample:1"]
    exposure = Exposure(convention, gain)
    check_oiiotool(tool_of(name), profiles, lights, exposure, tmp_path, 10000)
