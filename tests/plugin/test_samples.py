# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""sample:n is the same neutral in the plugin's files and in Python."""

import json
import subprocess

import pytest

import cg2raw
from images import attributes
from tiers import first_fast

INDICES = (0, 7, 31, 99999, 2147483647)


def as_shot_neutral(exiftool, path):
    """Return the three numbers of a DNG's AsShotNeutral."""
    command = [exiftool, "-j", "-n", "-AsShotNeutral", path]
    said = subprocess.run(command, capture_output=True, check=True).stdout
    return [float(word) for word in json.loads(said)[0]["AsShotNeutral"].split()]


@pytest.mark.parametrize("sensor", first_fast(cg2raw.installed_profiles(), 2))
def test_a_sample_is_the_same_neutral_everywhere(
    oiiotool, program, exr, tmp_path, sensor
):
    exiftool, out = program("exiftool"), tmp_path / "shot.dng"
    written, expected = [], []
    for index in INDICES:
        given = attributes(sensor=sensor, illuminant=f"sample:{index}", preview=0)
        oiiotool(exr, *given, "-o", out)
        written.append(as_shot_neutral(exiftool, out))
        light = cg2raw.Sensor(sensor).illuminant(f"sample:{index}")
        expected.append(list(light.neutral))
    assert written == expected  # AsShotNeutral counts millionths: nothing is lost
    assert len(set(map(tuple, written))) == len(INDICES)


def test_a_sensor_without_neutrals_samples_the_same_lights(
    oiiotool, program, exr, tmp_path
):
    profile = json.loads(cg2raw.Sensor("nikon-d40").to_json())
    del profile["illuminants"]
    path, out = tmp_path / "no-neutrals.json", tmp_path / "shot.dng"
    path.write_text(json.dumps(profile))
    for index in INDICES[:3]:
        given = attributes(sensor=path, illuminant=f"sample:{index}", preview=0)
        oiiotool(exr, *given, "-o", out)
        light = cg2raw.Sensor(path).illuminant(f"sample:{index}")
        assert as_shot_neutral(program("exiftool"), out) == list(light.neutral)
