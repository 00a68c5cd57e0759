# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How long each frame is exposed, which dark current and hot pixels grow with."""

import json

import numpy as np
import pytest

import cg2raw
from dataset.data_sets import rows, write_image
from python.commands import fails, run

PER_SECOND = 0.02  # of dark current, of the range
EXIF = 0.25  # s, as a float has it exactly
FEW = "--illuminants D65 --format npy".split()


@pytest.fixture
def sensor(repository, tmp_path):
    """Return the path of a profile with dark current and hot pixels."""
    text = (repository / "plugins/profiles/nikon-d40.json").read_text()
    dark = {"name": "dark_current", "parameters": {"per_second": PER_SECOND}}
    hot = {"name": "hot_pixels", "parameters": {"fraction": 1e-3, "rate": 0.5}}
    path = tmp_path / "warm.json"
    path.write_text(
        json.dumps(json.loads(text) | {"id": "warm", "effects": [dark, hot]})
    )
    return path


@pytest.fixture
def renders(tmp_path):
    """Return a folder of black images: one whose Exif has a time, one without."""
    black = np.zeros((64, 64, 3), np.float32)
    write_image(tmp_path / "renders/timed.exr", black, ExposureTime=EXIF)
    write_image(tmp_path / "renders/untimed.exr", black)
    return tmp_path / "renders"


def made(renders, out, *options):
    """Return {image: row} of a data set that could be made."""
    done = run("dataset", renders, out, *FEW, *options)
    assert done.code == 0, done
    return {row["input"]: row for row in rows(out)}


def dark_of(out, row):
    """Return the median signal of a packed file."""
    return np.median(np.load(out / row["path"]))


def test_the_option_is_that_of_all_images(sensor, renders, tmp_path):
    for seconds in (0.5, 4.0):
        out = tmp_path / f"out{seconds}"
        found = made(renders, out, "--sensors", sensor, "--exposure-time", seconds)
        for row in found.values():
            assert row["exposure_time"] == seconds
            dark = dark_of(out, row)
            assert dark == pytest.approx(seconds * PER_SECOND, abs=1e-3)


def test_else_it_is_the_images_own(sensor, renders, tmp_path):
    out = tmp_path / "out"
    done = run("dataset", renders, out, *FEW, "--sensors", sensor)
    assert done.code == 1
    assert (
        "untimed.exr: has no exposure time, and dark_current, hot_pixels of warm"
        in (done.err)
    )
    assert "--exposure-time SECONDS" in done.err
    [row] = rows(out)
    assert (row["input"], row["exposure_time"]) == ("timed.exr", EXIF)
    assert dark_of(out, row) == pytest.approx(EXIF * PER_SECOND, abs=1e-3)


def test_a_row_makes_its_file_again(sensor, renders, tmp_path):
    out = tmp_path / "out"
    words = ["--sensors", sensor, "--illuminants", "D65", "--exposure-time", "3"]
    assert run("dataset", renders, out, *words).code == 0
    for row in rows(out):
        metadata = cg2raw.read_dng_metadata(str(out / row["path"]))
        assert metadata.shot["exposure_time"] == 3.0
        frame = cg2raw.Sensor(str(sensor)).simulate(
            np.zeros((64, 64, 3), np.float32),
            illuminant=row["illuminant"],
            seed=row["seed"],
            frame=row["frame"],
            exposure_time=row["exposure_time"],
        )
        path = tmp_path / "again.dng"
        shot = {"exposure_time": row["exposure_time"]}
        cg2raw.write_dng(path, frame, preview=False, shot=shot)
        assert path.read_bytes() == (out / row["path"]).read_bytes()


def test_sensors_without_such_effects_need_none(renders, tmp_path):
    found = made(renders, tmp_path / "out", "--sensors", "nikon-d40")
    assert found["untimed.exr"]["exposure_time"] is None
    assert found["timed.exr"]["exposure_time"] == EXIF


def test_another_time_is_another_data_set(sensor, renders, tmp_path):
    out, words = tmp_path / "out", ["--sensors", sensor, "--exposure-time"]
    made(renders, out, *words, "0.5")
    message = fails("dataset", renders, out, *FEW, *words, "2")
    assert "was begun with --exposure-time 0.5, not 2.0" in message
    again = run("dataset", renders, out, *FEW, *words, "0.5")
    assert again.code == 0 and "2 of them kept" in again.out


def test_times_that_cannot_be(renders, tmp_path):
    words = ["--sensors", "nikon-d40", "--exposure-time"]
    for time in ("0", "-1", "nan", "long", "2e6", "1/0"):
        message = fails("dataset", renders, tmp_path / "out", *FEW, *words, time)
        assert "--exposure-time" in message and "seconds above 0" in message
    assert not (tmp_path / "out").exists()
