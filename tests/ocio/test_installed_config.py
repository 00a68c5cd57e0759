# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The generated config that is installed: it is up to date, and everybody reads it."""

import json
import os
import subprocess

import PyOpenColorIO as ocio
import pytest

from cg2raw import _core
from cg2raw_ocio.config import config_text, make_config
from ocio.conversion import system_python

# The paper's ten, and those that have noise.
SENSORS = (
    "canon-1ds-mark-iii canon-5d-mark-iv canon-600d canon-700d canon-70d fujifilm-x-m1 "
    "gopro-hero6-black nikon-d40 nikon-d5200 nikon-d850 olympus-e-pl6 panasonic-gx1 "
    "samsung-nx2000 samsung-s20fe sony-a57 sony-a7s-ii"
).split()
ILLUMINANTS = "A,D50,D65,sample:0-3"
OPTIONS = ("--sensors", ",".join(SENSORS), "--illuminants", ILLUMINANTS)


@pytest.fixture(scope="module")
def text(repository):
    return (repository / "ocio" / "sensors.ocio").read_text()


def test_it_is_what_the_generator_makes(text):
    profiles = [_core.load_profile(name) for name in SENSORS]
    config = make_config(profiles, _core.illuminant_list(ILLUMINANTS))
    assert config_text(config) == text, (
        f"run: cg2raw ocio {' '.join(OPTIONS)} -o ocio/sensors.ocio"
    )


def test_it_has_all_sensors_with_noise():
    noisy = [
        name
        for name in _core.installed_profiles()
        if json.loads(_core.load_profile(name).to_json()).get("noise")
    ]
    assert len(noisy) == 7 and set(noisy) <= set(SENSORS)


def test_debian_generates_the_same_bytes(text, build_folder):
    """PyOpenColorIO 2.1 and 2.6 write the same."""
    done = system_python(build_folder, "-m", "cg2raw", "ocio", *OPTIONS)
    assert done.stdout == text


def test_the_plugin_knows_every_name_and_alias(text):
    config = ocio.Config.CreateFromStream(text)
    spaces = config.getColorSpaces(
        ocio.SEARCH_REFERENCE_SPACE_SCENE, ocio.COLORSPACE_ALL
    )
    raw = [space for space in spaces if space.getFamily().startswith("RAW/")]
    assert len(raw) == 2 * 7 * len(SENSORS)
    for space in raw:
        sensor, illuminant = space.getName().split(" - ")[1:]
        assert sensor in SENSORS
        for name in (space.getName(), *space.getAliases()):
            found = _core.raw_space_from_name(name)
            assert (found[0], found[1].lower()) == (sensor, illuminant.lower())


def ocio_of_env(repository, **environment):
    """Return (OCIO, stderr) after scripts/env, where no OCIO but a given one is set."""
    kept = {name: value for name, value in os.environ.items() if name != "OCIO"}
    done = subprocess.run(
        ["bash", "-c", 'source scripts/env && printf %s "$OCIO"'],
        cwd=repository,
        env={**kept, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout, done.stderr


def test_env_exports_it(repository):
    installed = repository / "build/system/share/cg2raw/ocio/sensors.ocio"
    assert ocio_of_env(repository) == (str(installed), "")
    value, said = ocio_of_env(repository, OCIO="/studio/config.ocio")
    assert value == "/studio/config.ocio" and str(installed) in said
