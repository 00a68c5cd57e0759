# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames whose codes are coarse for their noise: numbers are right, or not there."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.calibration import UniformFrame, calibrate
from cg2raw.diagnose.captures import quality

SHAPE = (96, 128)


def sensor_of(bits, black, white):
    """Return a sensor without filters."""
    fields = {
        "schema": 1, "id": "coded", "make": "A", "model": "B", "sources": {},
        "unique_camera_model": "A B", "cfa": "mono", "width": SHAPE[1],
        "height": SHAPE[0], "bits": bits, "black_level": black, "white_level": white,
    }  # fmt: skip
    return Sensor.from_json(json.dumps(fields))


def frames_of(coded, gain, read, levels, seed=1, darks=5, flats=4):
    """Return darks and flats of one light and of exposures that are their levels.

    coded : of DN above black, which are not rounded yet, their codes. gain : electrons
    per DN. read : DN. levels : DN above black."""
    rng = np.random.default_rng(seed)
    plan = [("dark", 0.0, darks), *(("flat", level, flats) for level in levels)]
    found = []
    for kind, level, count in plan:
        for number in range(count):
            dn = rng.poisson(level * gain, SHAPE) / gain + rng.normal(0, read, SHAPE)
            raw = coded(dn).astype(np.uint16)
            name = f"{kind}-{level:g}-{number}"
            found.append(UniformFrame(name, kind, lambda raw=raw: raw, level, 100.0))
    return found


def profile_of(found):
    """Return (the profile, read noise of its row in DN, {effect: parameters})."""
    profile = json.loads(found.updated_profile())
    read = np.sqrt(profile["noise"][0]["beta2"]) * found.range
    return profile, read, {e["name"]: e["parameters"] for e in profile["effects"]}


WORD = sensor_of(16, 803, 65535)


def in_upper_bits(step, offset=3):
    """Return what codes DN above 803, rounded to steps from an offset of them all."""

    def coded(dn):
        steps = np.rint((dn + 803 - offset) / step)
        return np.clip(steps, 0, 65536 // step - 1) * step + offset

    return coded


@pytest.mark.parametrize(("step", "read"), [(4, 3.0), (16, 12.0), (64, 32.0)])
def test_fewer_bits_in_the_upper_ones_of_a_word(step, read):
    frames = frames_of(in_upper_bits(step), 0.25, read, (8000, 24000))
    found = calibrate(WORD, frames)
    profile, in_profile, effects = profile_of(found)
    gain = found.transfer.mean_gain
    assert abs(gain.value - 0.25) < 3 * gain.standard_error
    total = found.noise.mean_read_noise
    assert (
        abs(total.value**2 - read**2 - step**2 / 12) < 8 * read * total.standard_error
    )
    assert in_profile == pytest.approx(read, rel=0.02)
    assert effects["quantisation"]["step"] * found.range == pytest.approx(
        step, rel=1e-5
    )
    assert any(f"steps of {step} DN" in note for note in found.notes)
    calibrated = Sensor.from_json(json.dumps(profile))
    assert quality.step_of(calibrated) == step and quality.step_of(WORD) == 1


def test_two_codes_of_darks_show_their_step_and_white_may_lie_below_the_profile_s():
    frames = frames_of(in_upper_bits(16), 0.25, 3.0, (24000, 64600), flats=3)
    found = calibrate(WORD, frames)
    assert found.sites.step == 16 and found.transfer.clipped_by == "white level"
    assert calibrate(WORD, frames[:5]).sites.step == 16


def test_frames_that_are_coded_unlike_are_refused():
    plain, scaled = (
        frames_of(in_upper_bits(step), 0.25, 12.0, (8000,)) for step in (1, 16)
    )
    with pytest.raises(ValueError, match="only every 16th DN occurs, in other frames"):
        calibrate(WORD, [*plain[:6], replace(scaled[-1], raw=scaled[-1].raw)])
