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


def as_shot_neutrals(oiiotool, exiftool, exr, folder, sensor, indices):
    """Return the three numbers of AsShotNeutral in a DNG of each sample, written by
    one oiiotool and read by one exiftool."""
    words, paths = [], [folder / f"{index}.dng" for index in indices]
    for index, path in zip(indices, paths, strict=True):
        given = attributes(sensor=sensor, illuminant=f"sample:{index}", preview=0)
        words += [*given, "-o", path]
    oiiotool(exr, *words)
    command = [exiftool, "-j", "-n", "-AsShotNeutral", *paths]
    said = subprocess.run(command, capture_output=True, check=True).stdout
    return [list(map(float, one["AsShotNeutral"].split())) for one in json.loads(said)]


@pytest.mark.parametrize("sensor", first_fast(cg2raw.installed_profiles(), 2))
def test_a_sample_is_the_same_neutral_everywhere(
    oiiotool, program, exr, tmp_path, sensor
):
    lights = (cg2raw.Sensor(sensor).illuminant(f"sample:{n}") for n in INDICES)
    expected = [list(light.neutral) for light in lights]
    written = as_shot_neutrals(
        oiiotool, program("exiftool"), exr, tmp_path, sensor, INDICES
    )
    assert written == expected  # AsShotNeutral counts millionths: nothing is lost
    assert len(set(map(tuple, written))) == len(INDICES)


def test_a_sensor_without_neutrals_samples_the_same_lights(
    oiiotool, program, exr, tmp_path
):
    profile = json.loads(cg2raw.Sensor("nikon-d40").to_json())
    del profile["illuminants"]
    path = tmp_path / "no-neutrals.json"
    path.write_text(json.dumps(profile))
    lights = (cg2raw.Sensor(path).illuminant(f"sample:{n}") for n in INDICES[:3])
    expected = [list(light.neutral) for light in lights]
    assert expected == as_shot_neutrals(
        oiiotool, program("exiftool"), exr, tmp_path, path, INDICES[:3]
    )
