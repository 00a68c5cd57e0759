# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The commands of docs/calibrate.md's tutorial, run as they stand there on a camera's
frames: those of a sensor whose noise is known, which its photographs do not state."""

import glob
import json
import re
import shlex

import numpy as np
import pytest

import cg2raw
from calibration.planted import RANGE, sensor_of
from images import write_image
from python.commands import run

SHAPE = (128, 192)
# ISO -> electrons per DN, DN of read noise.
NOISE = {100: (2.5, 3.0), 800: (0.3125, 6.0)}
LIGHTS = ("A", "D50", "D65", "3400K", "7000K")


def row(iso):
    """Return the profile's row of noise at an ISO."""
    electrons, read = NOISE[iso]
    beta1, beta2 = 1 / (electrons * RANGE), (read / RANGE) ** 2
    return {"iso": iso, "beta1": [beta1] * 4, "beta2": [beta2] * 4}


def shoot(path, sensor, light, time=1 / 60, **run):
    """Write the DNG of one exposure of even light, white at 1."""
    path.parent.mkdir(parents=True, exist_ok=True)
    scene = np.full((*SHAPE, 3), light, np.float32)
    raw = sensor.simulate(scene, exposure_time=time, convention="sensor", **run)
    cg2raw.write_dng(path, raw, shot={"exposure_time": time})


@pytest.fixture(scope="module")
def page(repository):
    """Return the tutorial's text."""
    text = (repository / "docs/calibrate.md").read_text().replace("\\\n", " ")
    return text.partition("## From a camera to a noisy DNG")[2].partition("\n## ")[0]


@pytest.fixture(scope="module")
def done(page, tmp_path_factory):
    """Return the folder in which the commands ran, and what each printed."""
    folder = tmp_path_factory.mktemp("camera")
    sensor = sensor_of(shape=SHAPE, noise=[row(iso) for iso in NOISE])
    for number, light in enumerate(LIGHTS):
        shoot(folder / f"photos/{number}.dng", sensor, 0.3, illuminant=light)
    even = {"illuminant": "neutral:1:1", "camera_input": True}
    for iso in NOISE:
        for number in range(10):
            dark = folder / f"iso{iso}/darks/{number}.dng"
            shoot(dark, sensor, 0.0, 1 / 4000, iso=iso, frame=number, **even)
            flat = folder / f"iso{iso}/flats/{number}.dng"
            shoot(flat, sensor, 0.5, 0.1, iso=iso, frame=10 + number, **even)
    write_image(folder / "shot.exr", np.full((*SHAPE, 3), 0.18, np.float32))
    printed = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for line in re.findall(r"^    (cg2raw .*)", page, re.M):
            words = [w for word in shlex.split(line)[1:] for w in expanded(word)]
            printed[line] = run(*words)
    return folder, printed


def expanded(word):
    """Return the files of a pattern, as a shell does, or the word."""
    return sorted(glob.glob(word)) if "*" in word else [word]


def test_the_commands_run(done):
    folder, printed = done
    assert len(printed) == 5
    for line, command in printed.items():
        assert command.code == 0, (line, command)
    assert (folder / "shot.dng").exists()


def test_the_profile_has_the_noise_of_the_camera(done):
    folder, printed = done
    rows = json.loads((folder / "my-camera.json").read_text())["noise"]
    assert [found["iso"] for found in rows] == list(NOISE)
    for found in rows:
        planted = row(found["iso"])
        # Ten frames of 6144 pixels per site: standard errors of 1 to 2 %.
        for name in ("beta1", "beta2"):
            assert np.mean(found[name]) == pytest.approx(planted[name][0], rel=0.08)
    [shown] = [
        d.out for line, d in printed.items() if line.startswith("cg2raw sensors")
    ]
    assert "100-800 (50-1600)" in shown


def test_the_dng_is_as_noisy_as_the_camera_at_an_iso_between(done):
    folder, _ = done
    camera = sensor_of(shape=SHAPE, noise=[row(iso) for iso in NOISE])
    scene = np.full((*SHAPE, 3), 0.18, np.float32)
    mine = cg2raw.Sensor(folder / "my-camera.json")
    _, variance = mine.predict(scene, illuminant="D65", iso=400)
    _, planted = camera.predict(scene, illuminant="D65", iso=400)
    assert variance.mean() == pytest.approx(planted.mean(), rel=0.1)


def test_photographs_alone_have_no_noise_and_say_what_measures_it(done):
    folder, printed = done
    [made] = [d.out for line, d in printed.items() if line.startswith("cg2raw profile")]
    assert "noise" in made and "by cg2raw calibrate" in made
