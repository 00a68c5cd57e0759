# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames whose codes are coarse for their noise: numbers are right, or not there."""

import json
from dataclasses import replace

import numpy as np
import pytest

from calibration.planted import frame_of
from cg2raw import Sensor
from cg2raw.calibration import calibrate
from cg2raw.diagnose.captures import quality
from oracles import cameras
from tiers import slow

SHAPE = (96, 128)


def sensor_of(bits, black, white):
    """Return a sensor without filters."""
    levels = {"bits": bits, "black_level": black, "white_level": white, "noise": None}
    text = cameras.mono_text(**levels, width=SHAPE[1], height=SHAPE[0])
    return Sensor.from_json(text)


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
            name = f"{level:g}-{number}"
            found.append(frame_of(name, kind, coded(dn), level, white=65535))
    return found


def profile_of(found):
    """Return (the profile, read noise of its row in DN, {effect: parameters})."""
    profile = json.loads(found.updated_profile())
    read = np.sqrt(profile["noise"][0]["beta2"]) * found.range
    effects = {e["name"]: e["parameters"] for e in profile.get("effects", [])}
    return profile, read, effects


WORD = sensor_of(16, 803, 65535)


def in_upper_bits(step, offset=3):
    """Return what codes DN above 803, rounded to steps from an offset of them all."""

    def coded(dn):
        steps = np.rint((dn + 803 - offset) / step)
        return np.clip(steps, 0, 65536 // step - 1) * step + offset

    return coded


@pytest.mark.parametrize(("step", "read"), [(16, 12.0), (64, 32.0), slow(4, 3.0)])
def test_fewer_bits_in_the_upper_ones_of_a_word(step, read):
    frames = frames_of(in_upper_bits(step), 0.25, read, (8000, 24000))
    found = calibrate(WORD, frames)
    profile, in_profile, effects = profile_of(found)
    gain = found.figure("gain")
    assert abs(gain.value - 0.25) < 3 * gain.standard_error
    total = found.figure("temporal dark noise")
    assert (
        abs(total.value**2 - read**2 - step**2 / 12) < 8 * read * total.standard_error
    )
    assert in_profile == pytest.approx(read, rel=0.02)
    planted = {"read noise": read, "gain": 0.25, "black level": 803.0}
    for one in found.fit.figures:
        if one.name in planted:
            off = one.value - planted.pop(one.name)
            assert abs(off) < 4 * one.standard_error
    assert not planted
    in_effect = effects["quantisation"]["step"] * found.range
    assert in_effect == pytest.approx(step, rel=1e-5)
    assert any(f"steps of {step} DN" in note for note in found.notes)
    calibrated = Sensor.from_json(json.dumps(profile))
    assert quality.step_of(calibrated) == step and quality.step_of(WORD) == 1
    assert calibrated.cfa == "MONO"


def test_two_codes_of_darks_show_their_step_and_white_may_lie_below_the_profile_s():
    frames = frames_of(in_upper_bits(16), 0.25, 3.0, (24000, 64600), flats=3)
    found = calibrate(WORD, frames)
    assert found.sites.step == 16 and found.transfer.clipped_by == "white level"
    assert calibrate(WORD, frames[:5]).sites.step == 16


def test_frames_that_are_coded_unlike_are_refused():
    plain, scaled = (
        frames_of(in_upper_bits(step), 0.25, 12.0, (8000,)) for step in (1, 16)
    )
    with pytest.raises(ValueError, match="only one in 16 DN occurs, in other frames"):
        calibrate(WORD, [*plain[:6], replace(scaled[-1], raw=scaled[-1].raw)])


def whole(black, low=0, white=4095):
    """Return what codes DN as whole ones above @black, cut at @low."""
    return lambda dn: np.clip(np.rint(dn + black), low, white)


@pytest.mark.parametrize(
    ("black", "low"), [(0.0, 0), (-3.0, 0), (64.0, 64), slow(5.3, 0)]
)
def test_noise_that_is_cut_at_the_lowest_code(black, low):
    """Darks show their level and noise, by what is left of them. 0.15 DN are two errors
    of levels of a fifth of the pixels."""
    sensor = sensor_of(12, max(black, 0), 4095)
    frames = frames_of(whole(black, low), 2.0, 5.0, (40, 160, 640))
    found = calibrate(sensor, frames)
    assert found.fit.lost == "cut" and found.structure is None
    assert found.each("black level")[0].value == pytest.approx(black, abs=0.15)
    gain = found.figure("gain")
    assert abs(gain.value - 2.0) < 3 * gain.standard_error < 0.1
    _, in_profile, effects = profile_of(found)
    assert in_profile == pytest.approx(5.0, rel=0.04) and not effects
    assert found.figure("read noise").value == pytest.approx(in_profile, rel=0.01)
    assert any("noise is cut at the lowest code" in note for note in found.notes)


def test_darks_of_which_nothing_is_left_say_no_number():
    frames = frames_of(whole(-30.0), 2.0, 5.0, (100, 640))
    found = calibrate(sensor_of(12, 0, 4095), frames)
    assert found.fit.lost == "cut" and not found.each("black level")
    alone = calibrate(sensor_of(12, 0, 4095), frames[:5])
    assert not alone.fit.figures
    assert "noise" not in json.loads(alone.updated_profile())


@pytest.mark.parametrize(
    ("bits", "gain", "black", "read", "levels"),
    [
        (8, 150.0, 6.0, 0.05, (8, 30, 60, 120)),
        (8, 150.0, 6.3, 0.15, (1.2, 40, 120)),  # half of 7 DN and of 8
        slow(8, 200.0, 6.3, 0.35, (2, 20, 60, 120, 180)),
        (12, 900.0, 64.3, 0.02, (300, 1200)),
        slow(12, 900.0, 64.0, 0.02, (1200,)),
    ],
)
def test_gain_where_rounding_hides_the_read_noise(bits, gain, black, read, levels):
    """Of an even prior for the intercept, one level of 1.3 DN^2 is known to 4 %."""
    white = 2**bits - 1
    frames = frames_of(whole(black, white=white), gain, read, levels, flats=6)
    found = calibrate(sensor_of(bits, round(black), white), frames)
    measured = found.figure("gain")
    assert abs(measured.value - gain) < 3 * measured.standard_error < 0.15 * gain
    assert found.fit.lost == "coarse" and found.tails is None
    off = abs(found.each("black level")[0].value - black)
    error = found.each("black level")[0].standard_error
    assert off < 2 * error and error < 0.3  # DN: it lies within a code
    _, in_profile, effects = profile_of(found)
    assert in_profile < 0.4 and found.transfer.saturation is None
    assert not set(effects) - {"lens_shading"}
    assert any("read noise: below 0.4 DN" in note for note in found.notes)


def test_flats_that_show_rounding_alone_give_no_gain():
    frames = frames_of(whole(6.3, white=255), 200.0, 0.1, (3, 8))
    found = calibrate(sensor_of(8, 6, 255), frames)
    assert found.figure("gain") is None and found.light is None
    assert any("by rounding more than by light" in note for note in found.notes)


def root(dn):
    """Return codes of 12 bits that are the root of DN of 16 bits."""
    return np.rint(np.sqrt(np.clip(dn + 256, 0, 65535) / 65535) * 4095)


def logarithm(dn):
    """Return codes of 10 bits that are a logarithm of DN of 16 bits."""
    return np.rint(np.log2(np.clip(dn + 256, 1, 65535)) / 16 * 1023)


def knee(dn):
    """Return codes that rise by a quarter above 8000 DN, as of two exposures."""
    return np.rint(np.interp(dn + 256, (0, 8000, 40000), (0, 8000, 16000)))


@pytest.mark.parametrize(
    ("coded", "bits", "black"),
    [(root, 12, 256.0), (logarithm, 10, 511.5), (knee, 14, 256.0)],
)
def test_codes_that_follow_a_curve_are_refused(coded, bits, black):
    frames = frames_of(coded, 2.0, 6.0, (1000, 4000, 12000, 20000, 35000))
    with pytest.raises(ValueError, match="codes follow a curve of light"):
        calibrate(sensor_of(bits, black, 2**bits - 1), frames)


def table(dn, bits=8):
    """Return DN of 16 bits that a table makes of roots of fewer bits."""
    most = 2**bits - 1
    codes_of_root = np.rint(np.sqrt(np.clip(dn + 256, 0, 65535) / 65535) * most)
    return np.rint((codes_of_root / most) ** 2 * 65535)


def test_codes_that_a_table_put_back_are_refused():
    frames = frames_of(table, 2.0, 6.0, (1000, 20000))
    with pytest.raises(ValueError, match="flat-20000-.: its codes are .* companded"):
        calibrate(sensor_of(16, 256, 65535), frames)


@pytest.mark.parametrize("factor", [1.5, 2.4])
def test_values_that_were_scaled_are_not_companded(factor):
    def scaled(dn):
        return np.rint(np.rint(dn / factor) * factor) + 256

    frames = frames_of(scaled, 2.0, 6.0, (1000, 20000))
    assert calibrate(sensor_of(16, 256, 65535), frames).transfer.points


def test_a_full_well_is_no_curve():
    """Nor where it is reached in the middle of a vignetted field first."""
    rows, columns = np.mgrid[-1:1:96j, -1:1:128j]
    light = 1 - 0.3 * (rows**2 + columns**2)

    def full(dn):
        return np.rint(np.minimum(dn * light, 3000 + 0.02 * dn) + 64)

    frames = frames_of(full, 2.0, 6.0, (500, 1500, 3100, 3600, 4500))
    found = calibrate(sensor_of(12, 64, 4095), frames)
    assert found.transfer.clipped_by == "full well"
