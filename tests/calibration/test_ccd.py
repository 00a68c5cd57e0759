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


def test_what_a_calibration_adds_to_the_figures_of_the_model(found):
    """Those are compared with plain statistics in tests/model/test_figures.py."""
    assert found.black.mean() == pytest.approx(993, abs=1)
    assert found.dark.rate.value == pytest.approx(0.350, rel=0.03)
    along_columns = found.figure("correlation, next in column")
    assert along_columns.value == pytest.approx(0, abs=0.004)
    assert found.lamp.value == pytest.approx(0.0023, rel=0.1)
    assert found.structure.edge.value == pytest.approx(13, abs=3)
    assert not found.tails.are_heavy
    assert found.tails.tukey_lambda == pytest.approx(0.13, abs=0.02)
