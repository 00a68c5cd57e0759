# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames of a real CCD, whose numbers plain statistics know; not in the repository."""

import csv
import json

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
# Where the model measures something else than the plain formulas do, and how far apart
# the two are: by the model over by hand.
OTHERWISE = {
    # Masks leave out pixels of more than 0.6 DN/s, by hand only those above 0.9: these
    # leak while the bias is read. All but polynomials, not waves of 32 px and shorter.
    "dsnu": ("DSNU", (0.5, 0.7)),
    # One column is bright from row 490 on: it is masked here.
    "column_fixed_pattern": ("fixed column pattern", (0.6, 0.72)),
    # High-pass by hand, without what is far off; here all that masks leave but
    # polynomials: 0.3 % beyond six sigma are a seventh of the variance.
    "prnu": ("PRNU", (1.05, 1.22)),
}
LIKEWISE = {
    "black_level": "black level",
    "drift": "black level drift",
    "read_noise": "temporal dark noise",
    "row_noise": "row noise",
    "correlation": "correlation, next in row",
    "dark_current": "dark current",
    "gain": "gain",
}
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


@pytest.fixture(scope="module")
def by_hand(repository):
    """Return what plain formulas give: {name: {value, error, ...}}."""
    return json.loads((repository / "studies/diagnose/frozen/by_hand.json").read_text())


def value_of(found, name):
    """Return the value of a figure."""
    [value] = [one.value for one in found.fit.figures if one.name == name]
    return value


@pytest.mark.parametrize("name", LIKEWISE)
def test_a_real_sensor_is_as_by_hand(found, by_hand, name):
    """Within 1 % or two standard errors of the plain formula, whichever is larger."""
    plain = by_hand[name]
    within = max(0.01 * abs(plain["value"]), 2 * plain["error"])
    assert value_of(found, LIKEWISE[name]) == pytest.approx(plain["value"], abs=within)


@pytest.mark.parametrize("name", OTHERWISE)
def test_a_real_sensor_by_another_definition(found, by_hand, name):
    figure, (low, high) = OTHERWISE[name]
    assert low < value_of(found, figure) / by_hand[name]["value"] < high


def test_what_is_beside_the_figures(found):
    assert found.dark.rate.value == pytest.approx(0.350, rel=0.03)
    along_columns = found.figure("correlation, next in column")
    assert along_columns.value == pytest.approx(0, abs=0.004)
    assert found.lamp.value == pytest.approx(0.0023, rel=0.1)
    assert found.structure.edge.value == pytest.approx(13, abs=3)
    assert not found.tails.are_heavy
    assert found.tails.tukey_lambda == pytest.approx(0.13, abs=0.02)
