# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames of a real CCD, whose numbers plain statistics know; not in the repository."""

import csv

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.calibration import UniformFrame, calibrate
from oracles import cameras

FILES = (
    "bias_-5C",
    "dark_60s_-5C",
    "dark_series_-10C",
    "dark_series_-5C",
    "flat_23s_-5C",
)
BLACK, WHITE = 1000.0, 65535  # of its header
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def ccd(camera_data):
    """Return the folder of the CCD's frames, or skip."""
    folder = camera_data / "real" / "ccd"
    if not (folder / "frames.csv").is_file():
        pytest.skip(f"no frames of the CCD in {folder}")
    return folder


@pytest.fixture(scope="module")
def found(ccd):
    """Return the calibration of all frames, by its header's sensor."""
    with open(ccd / "frames.csv") as file:
        said = {row["frame"]: row for row in csv.DictReader(file)}
    frames = []
    for name in FILES:
        stored = np.load(ccd / f"{name}.npz")
        frames += [
            UniformFrame(
                frame,
                "flat" if name.startswith("flat") else "dark",
                lambda stored=stored, frame=frame: stored[frame],
                float(said[frame]["exposure_s"]),
                100.0,
                float(said[frame]["temperature_c"]),
            )
            for frame in sorted(stored.files)
        ]
    levels = {"bits": 16, "black_level": BLACK, "white_level": WHITE}
    sensor = Sensor.from_json(cameras.mono_text(**levels, width=1024, height=1024))
    return calibrate(sensor, frames)


def test_the_numbers_of_plain_statistics(found):
    assert found.figure("temporal dark noise").value == pytest.approx(6.70, rel=0.01)
    assert found.figure("gain").value == pytest.approx(1.93, rel=0.01)
    assert found.black.mean() == pytest.approx(993, abs=1)
    assert found.dark.rate.value == pytest.approx(0.350, rel=0.03)
    assert found.figure("correlation, next in row").value == pytest.approx(
        -0.068, abs=0.004
    )
    assert found.figure("correlation, next in column").value == pytest.approx(
        0, abs=0.004
    )
    # By hand 0.0039 of pixels that are like most, 0.0055 of all but hot ones.
    assert found.figure("PRNU").value == pytest.approx(0.0043, rel=0.02)
    assert found.lamp.value == pytest.approx(0.0023, rel=0.1)


def test_levels_move_and_rows_do_a_little(found):
    """Medians of whole DN move by 0.45 DN, means of the same frames by 0.33. Rows have
    0.139 +- 0.004 DN by cosines of 12 half waves down the frame or more."""
    assert 0.3 < found.figure("black level drift").value < 0.5
    rows = found.figure("row noise")
    within = 2 * np.hypot(0.004, rows.standard_error)
    assert rows.value == pytest.approx(0.139, abs=within)
    assert found.structure.edge.value == pytest.approx(13, abs=3)


def test_no_tails_are_named(found):
    assert not found.tails.are_heavy
    assert found.tails.tukey_lambda == pytest.approx(0.13, abs=0.02)
