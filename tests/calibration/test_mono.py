# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Darks and flats of a sensor without filters: one site, one black level."""

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.calibration import UniformFrame, calibrate
from oracles import cameras

SHAPE, ISO = (128, 160), 100.0
SPAN = 16383 - 256
ELECTRONS_PER_DN, READ_DN = 2.0, 4.0


def sensor_of(black):
    """Return the planted sensor, with another black level."""
    slope = 1 / ELECTRONS_PER_DN / SPAN
    noise = {"iso": ISO, "beta1": slope, "beta2": (READ_DN / SPAN) ** 2}
    return Sensor.from_json(
        cameras.mono_text(id="planted", black_level=black, noise=[noise])
    )


def frames_of(sensor):
    """Return ten biases and ten flats at half of white."""
    frames = []
    for number in range(20):
        kind, level = ("dark", 0.0) if number < 10 else ("flat", 0.5)
        grey = np.full((*SHAPE, 3), level, np.float32)
        run = {"iso": ISO, "frame": number, "convention": "sensor"}
        raw = np.asarray(sensor.simulate(grey, **run))
        seconds = 0.0 if kind == "dark" else 1.0
        take = lambda raw=raw: raw  # noqa: E731
        frames.append(UniformFrame(f"{kind}{number}", kind, take, seconds, ISO, None))
    return frames


def test_one_site_is_measured():
    """Ten frames of 20,480 pixels: black within 0.05 DN, noise within 1 %, the gain,
    from 184,320 differences, within 2 %."""
    truth, assumed = sensor_of(256), sensor_of(250)
    found = calibrate(assumed, frames_of(truth))
    black = found.figure("black level")
    assert black.value == pytest.approx(256, abs=0.05)
    repaired = Sensor.from_json(found.updated_profile())
    (row,) = repaired.noise
    assert repaired.cfa == "MONO"
    gain = 1 / row["beta1"][0] / (16383 - repaired.black_level[0])
    assert gain == pytest.approx(ELECTRONS_PER_DN, rel=0.02)
    read = np.sqrt(row["beta2"][0]) * SPAN
    assert read == pytest.approx(READ_DN, rel=0.01)
