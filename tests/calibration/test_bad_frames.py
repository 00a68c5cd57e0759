# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames that cannot be calibrated are refused in one sentence; few are made use of."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.planted import GAIN, WHITE, frames_of, sensor_of
from cg2raw.calibration import UniformFrame, calibrate
from tiers import slow

SENSOR = sensor_of(shape=(64, 96))
FRAMES = frames_of(SENSOR, biases=2, darks=2, flats=2)
BRIGHT = FRAMES[4].pixels().astype(np.uint16)


def frame(array, kind="dark"):
    """Return a frame of an array."""
    return UniformFrame("odd", kind, lambda: array, 0.0, 100.0)


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        (FRAMES[:1], "give two that repeat each other"),
        ([FRAMES[0], FRAMES[2]], "no other frame has its kind, exposure"),
        ([*FRAMES, replace(FRAMES[0], iso=200.0)], "calibrate one ISO at a time"),
        ([*FRAMES, frame(np.full((48, 64), 256, np.uint16))], "of one size"),
        ([*FRAMES, frame(np.full((32, 32), 256, np.uint16))], "at least 48 pixels"),
        ([*FRAMES, frame(np.full((64, 96), 256.0))], "uint16"),
        ([frame(np.full((64, 96), WHITE, np.uint16), "flat")] * 2, "expose less"),
        ([*FRAMES, frame(np.full((64, 96), 2**15, np.uint16))], "does not fit into"),
        ([replace(FRAMES[2], exposure_time=None), *FRAMES], "no exposure time"),
        ([replace(FRAMES[0], kind="flat"), *FRAMES[1:]], "is it a dark?"),
        ([*FRAMES, frame(BRIGHT // 16 * 16, "flat")], "only one in 16 DN occurs"),
        ([*FRAMES, frame(np.minimum(BRIGHT // 32, 255), "flat")], "an 8-bit copy"),
    ],
)
def test_bad_frames_are_refused(frames, words):
    with pytest.raises(ValueError) as error:
        calibrate(SENSOR, frames)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_darks_alone_show_all_but_light():
    found = calibrate(SENSOR, FRAMES[:4])
    assert found.tails and found.dark and found.each("black level")
    assert not found.transfer.points and found.light is None
    assert any("no flats" in note for note in found.notes)
    assert found.updated_profile()


def test_flats_alone_show_gain_by_the_profile_s_black_and_noise():
    found = calibrate(SENSOR, FRAMES[4:])
    assert not found.each("black level") and found.tails is None
    gain = found.figure("gain")
    assert abs(gain.value - GAIN) < 4 * gain.standard_error
    assert any("no darks" in note for note in found.notes)


def test_flats_that_are_saturated_show_no_more_than_darks():
    full = [
        replace(one, raw=lambda: np.full((64, 96), WHITE, np.uint16))
        for one in FRAMES[4:]
    ]
    found = calibrate(SENSOR, [*FRAMES[:2], *full])
    assert found.tails and found.each("black level") and not found.transfer.points
    assert found.updated_profile()


def test_hot_pixels_dust_and_cosmic_rays_move_no_number():
    rng = np.random.default_rng(5)
    hot = rng.random((64, 96)) < 0.017
    dust = np.ones((64, 96))
    dust[20:30, 40:50] = 0.7

    def spoiled(one):
        raw = one.pixels().astype(float)
        if one.kind == "flat":
            raw = 256 + (raw - 256) * dust
        raw[hot] += 400
        raw[rng.integers(64, size=3), rng.integers(96, size=3)] += 3000
        pixels = np.clip(raw, 0, WHITE).astype(np.uint16)
        return replace(one, raw=lambda: pixels)

    frames = frames_of(SENSOR, biases=5, darks=0, flats=5)
    clean, found = (
        calibrate(SENSOR, some) for some in (frames, [spoiled(f) for f in frames])
    )
    assert sum(found.transients.values()) >= 25
    for look in (
        lambda c: c.figure("temporal dark noise"),
        lambda c: c.figure("row noise"),
        lambda c: c.figure("gain"),
        lambda c: c.each("black level")[0],
    ):
        a, b = look(clean), look(found)
        assert abs(a.value - b.value) < 3 * b.standard_error, (a, b)


@pytest.mark.parametrize("darks", [FRAMES[:2], slow(FRAMES[:4])], ids=len)
def test_the_result_is_the_same_on_any_number_of_threads(darks):
    one, two = (calibrate(SENSOR, darks + FRAMES[4:], threads=n) for n in (1, 2))
    assert one.updated_profile() == two.updated_profile()
