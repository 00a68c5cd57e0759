# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sweep of light by exposure time, from below the read noise to white."""

import csv
import json
import sys

import numpy as np
import pytest

from calibration.planted import BLACK, GAIN, READ, WHITE, frame_of, sensor_of
from cg2raw import Sensor
from cg2raw.calibration import UniformFrame, calibrate
from oracles import cameras

SHAPE = (96, 128)
SENSOR = sensor_of(shape=SHAPE)
TIMES = (0.0003, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 1.2, 1.3)
RANGE = WHITE - BLACK


def swept(loss=0.0, early=0.0, well=np.inf):
    """Return the calibration of two darks, and of two flats at each time; in a second
    they fill the range. loss, well : of white; the loss is quadratic. early : s that
    the shutter is."""
    frames = []
    for number, time in enumerate(2 * [0.0] + sorted(2 * TIMES)):
        kind = "flat" if time else "dark"
        rng = np.random.default_rng(number)
        light = (time + early) * (1 - loss * min(time, 1.0)) * (kind == "flat")
        above = rng.poisson(light * RANGE * GAIN, SHAPE) / GAIN
        above = np.minimum(above, well * RANGE)
        dn = above + rng.normal(BLACK, READ, SHAPE)
        frames.append(frame_of(number, kind, dn, time))
    return calibrate(SENSOR, frames)


def effects_of(found):
    """Return the names of the effects that a calibration writes."""
    profile = json.loads(found.updated_profile())
    return [effect["name"] for effect in profile.get("effects", [])]


def test_a_flat_darker_than_the_read_noise_is_no_full_well():
    """Its variance over its level is seven times that of light."""
    found = swept()
    gain = found.figure("gain")
    assert abs(gain.value - GAIN) < 4 * gain.standard_error
    assert found.transfer.clipped_by == "white level"
    assert found.transfer.saturation.value == pytest.approx(RANGE, abs=1)
    assert found.linearity.error.value < 0.05
    assert effects_of(found) == []


def test_beside_such_a_flat_a_full_well_is_found():
    """Its noise is that of the readout, which that flat has too."""
    found = swept(well=0.9)
    assert found.transfer.clipped_by == "full well"
    assert found.transfer.saturation.value == pytest.approx(0.9 * RANGE, rel=1e-3)


def test_flats_beyond_a_full_well_mask_no_pixels(monkeypatch):
    """They are not looked at again: that of 0.8 s is the last below 0.9 of white."""
    module, looks = sys.modules[calibrate.__module__], []
    look = module.seen_all

    def seen_all(sensor, sites, groups, *more):
        looks.append(groups[-1].exposure_time)
        return look(sensor, sites, groups, *more)

    monkeypatch.setattr(module, "seen_all", seen_all)
    swept(well=0.9)
    assert looks[0] > 0.9 and looks[-1] == 0.8


def test_a_shutter_that_opens_early_bends_no_line():
    """EMVA 1288 lays its line with an offset."""
    found = swept(early=0.002)
    assert found.linearity.error.value < 0.05


@pytest.mark.parametrize(("loss", "is_written"), [(0.01, False), (0.04, True)])
def test_a_bend_that_lamps_have_too_is_a_note(loss, is_written):
    found = swept(loss)
    bend = found.linearity.quadratic
    assert bend.stands_out
    assert bend.value == pytest.approx(loss, rel=0.15)
    assert ("nonlinearity" in effects_of(found)) == is_written
    assert any("lamps and shutters" in note for note in found.notes) != is_written


def test_a_real_sweep(camera_data):
    """A machine-vision CCD; truths by plain photon transfer. Its levels bend by 2 % of
    white with exposure time, and nobody knows whether that is its lamp."""
    folder = camera_data / "real2" / "emva_ccd12"
    if not (folder / "frames.csv").is_file():
        pytest.skip(f"no frames of a light sweep in {folder}")
    stored = np.load(folder / "frames.npz")
    with open(folder / "frames.csv") as file:
        rows = list(csv.DictReader(file))
    frames = [
        UniformFrame(
            row["frame"],
            row["kind"],
            lambda name=row["frame"]: stored[name],
            float(row["exposure_s"]),
            100.0,
        )
        for row in rows
        if row["kind"] == "flat" or row["exposure_s"] == "0.00516"
    ]
    text = cameras.mono_text(id="sweep", bits=12, black_level=16, white_level=4095)
    found = calibrate(Sensor.from_json(text), frames)
    assert found.figure("gain").value == pytest.approx(3.58, rel=0.01)
    assert found.transfer.saturation.value == pytest.approx(4080, abs=2)
    assert found.figure("PRNU").value == pytest.approx(0.0026, rel=0.05)
    assert found.figure("row noise").value == pytest.approx(0.50, abs=0.03)
    assert found.linearity.error.value < 0.3
    assert not {"full_well", "nonlinearity", "hot_pixels"} & set(effects_of(found))
    assert found.defects is None and not found.excluded
