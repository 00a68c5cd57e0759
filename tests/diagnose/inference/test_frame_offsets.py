# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What pixels of one frame share is no map of the sensor."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.frame_offsets import without_shared_offsets
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    READ,
    SHAPE,
    capture_of,
    cut_at_zero,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
ROWS = 0.8  # read noises
AMPLITUDE, PERIOD = 0.03, 40.0


def darks(count, seed, *extra):
    captures = [capture_of("dark", n, name=f"d{n}") for n in range(count)]

    def offsets(frame, rng):
        rows = ROWS * READ * rng.standard_normal((1, SHAPE[0], 1))
        return sum((one for one in extra), rows)

    return drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, offsets)


def spread_of_rows(frame):
    return np.std(frame.signal[0, 20:-20, 20:-20].mean(1))


def test_rows_are_level_and_pixels_as_noisy_as_they_were():
    frames = darks(2, 3)
    model = model_of(SENSOR, row_noise=[ROWS])
    shown = without_shared_offsets(model, on(frames)).frames
    for before, after in zip(frames, shown, strict=True):
        assert spread_of_rows(after) < 0.2 * spread_of_rows(before)
        own = after.signal[0, 20:-20, 20:-20].std()
        assert own == pytest.approx(READ, rel=0.02)


def test_a_model_without_offsets_leaves_frames_as_they_are():
    frames = darks(1, 4)
    [same] = without_shared_offsets(Model(SENSOR), on(frames)).frames
    assert same is frames[0]


def test_rows_of_frames_that_the_adc_cuts_are_level_too():
    model = model_of(SENSOR, row_noise=[ROWS])
    frames = cut_at_zero(darks(1, 5))
    [after] = without_shared_offsets(model, on(frames)).frames
    moved = (frames[0].signal - after.signal)[0].mean(1)
    rows = frames[0].signal[0].mean(1)
    assert np.corrcoef(moved[20:-20], rows[20:-20])[0, 1] > 0.95


def test_offsets_of_pixels_do_not_have_the_spread_of_rows():
    """Two darks, of which rows differ as much as pixels do."""
    offsets = 0.3 * READ * np.random.default_rng(6).standard_normal((1, *SHAPE))
    start = model_of(SENSOR, row_noise=[ROWS], dsnu=[0.0])
    model = fit_patterns(start, on(darks(2, 7, offsets)))
    assert model.term("dsnu").values[0] == pytest.approx(0.3 * READ, rel=0.12)


def test_gains_of_pixels_do_not_have_the_waves_of_a_lamp():
    gains = 0.01 * np.random.default_rng(9).standard_normal((1, *SHAPE))

    def flickering(frame, rng):
        turns = np.arange(SHAPE[0])[:, None] / PERIOD + rng.random()
        waves = AMPLITUDE * np.cos(2 * np.pi * turns)
        return predict(Model(SENSOR), frame).exposed * (waves + gains)

    captures = [capture_of("flat", n, name=f"f{n}", level=0.4) for n in range(4)]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), 10, flickering)
    start = model_of(SENSOR, mains_flicker=[AMPLITUDE, PERIOD], prnu=[0.0])
    found = fit_patterns(start, on(frames)).term("prnu").values[0]
    assert found == pytest.approx(0.01, rel=0.05)


def test_a_row_of_one_pixel_leaves_that_a_number():
    """All it shows may be what it shares with the frame."""
    [frame] = darks(1, 8)
    keep = frame.keep.copy()
    keep[:, 20:30] = False
    keep[:, 25, 40] = True
    model = model_of(SENSOR, row_noise=[4.0], black_level_drift=[4.0])
    [shown] = without_shared_offsets(model, on([replace(frame, keep=keep)])).frames
    assert np.isfinite(shown.signal).all()
