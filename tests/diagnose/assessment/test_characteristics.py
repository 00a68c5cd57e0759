# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Photon transfer, dark current and fixed patterns are those that were planted."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.assessment.characteristics import characteristics_of, pairs_of
from cg2raw.diagnose.assessment.patterns import PatternSums, is_uniform, patterns_of
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    FULL_WELL,
    ONE,
    capture_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

SENSOR = sensor_of()
RANGE = 16383 - 256  # DN
TIMES = (1.0, 4.0)


def captures(kinds=("dark", "flat"), repeats=2, levels=(0.1, 0.6)):
    """Return report captures: darks of two times, flats of two levels, repeated."""
    found = []
    for n in range(repeats):
        for time, level in zip(TIMES, levels, strict=True):
            for kind in kinds:
                seconds = time if kind == "dark" else 1.0
                name = f"{kind}{time}-{n}"
                found.append(
                    capture_of(kind, n, name=name, set=name, group="report",
                               level=level, exposure_time=seconds)
                )  # fmt: skip
    return found


def found_in(shown, true, base=None):
    return characteristics_of(base or Model(SENSOR), true, Splits(shown, ONE), [])


@pytest.fixture(scope="module")
def frames():
    return frames_of(SENSOR, captures())


def test_the_curve_is_the_noise_that_was_drawn(frames):
    """Variances of 64 x 96 pixels less their borders are known to 2 % in darks; points
    of eighths of a flat to 7 %."""
    true = model_of(SENSOR, shot_noise=[0.5], read_noise=[0.7])
    transfer = found_in(drawn(frames, true, 3), true).transfer
    ratio = transfer.measured / transfer.after
    assert len(ratio) == 2 + 2 * 8 and transfer.held_out.all()
    assert np.abs(ratio - 1).max() < 4 * 0.07
    assert np.mean(ratio) == pytest.approx(1, abs=4 * 0.07 / np.sqrt(18))
    lit = transfer.x > 100
    less = transfer.before / transfer.after
    assert less[~lit] == pytest.approx(np.exp(-0.7), rel=0.02)
    assert less[lit] == pytest.approx(np.exp(-0.5), rel=0.02)
    [dim] = [f for f in frames if f.capture.name == "flat1.0-0"]
    lowest = (predict(true, dim).mean * dim.range).min()
    assert transfer.x[lit].min() == pytest.approx(lowest, rel=0.05)


def test_what_is_fixed_is_not_in_it(frames):
    fixed = 0.02 * np.random.default_rng(1).standard_normal((1, 64, 96))
    clean, patterned = (
        found_in(drawn(frames, Model(SENSOR), 3, extra), Model(SENSOR)).transfer
        for extra in (0.0, fixed)
    )
    assert np.mean(fixed**2) * RANGE**2 > 100 * clean.measured.min()
    assert patterned.measured == pytest.approx(clean.measured, rel=0.25)


def test_a_hot_pixel_that_flickers_does_not_make_it(frames):
    shown = drawn(frames, Model(SENSOR), 3)
    signal = shown[0].signal.copy()
    signal[0, 30, 40] = 0.9
    rayed = [replace(shown[0], signal=signal), *shown[1:]]
    clean, hit = (found_in(f, Model(SENSOR)).transfer for f in (shown, rayed))
    assert hit.measured == pytest.approx(clean.measured, rel=0.02)


def test_electrons_are_those_of_the_planted_gain(frames):
    shown = drawn(frames, Model(SENSOR), 3)
    per_dn = found_in(shown, Model(SENSOR)).electrons_per_dn
    assert per_dn == pytest.approx(FULL_WELL / RANGE, rel=1e-3)
    noisier = model_of(SENSOR, shot_noise=[np.log(2)])
    assert found_in(shown, noisier).electrons_per_dn == pytest.approx(per_dn / 2)


def test_repeats_are_of_the_same_light_and_time():
    every = frames_of(SENSOR, captures(repeats=3))
    names = [tuple(f.capture.name for f in pair) for pair in pairs_of(
        drawn(every, Model(SENSOR), 1))]  # fmt: skip
    assert len(names) == 4  # of three repeats one is left
    assert all(a.partition("-")[0] == b.partition("-")[0] for a, b in names)


def test_the_dark_line_is_the_planted_current(frames):
    rate = 0.002  # of the range, per second
    true = model_of(SENSOR, dark_current=[rate])
    levels = found_in(drawn(frames, true, 5), true).dark_levels
    assert levels.x.tolist() == [1, 1, 4, 4]
    # Of the median: read noise and that of the charge are 23 DN at most.
    error = 4 * 1.25 * 23 / np.sqrt(56 * 88)
    assert levels.measured == pytest.approx(rate * RANGE * levels.x, abs=error)
    assert levels.after == pytest.approx(levels.measured, abs=error)
    assert levels.before == pytest.approx(np.zeros(4), abs=error)


@pytest.mark.parametrize(
    ("kinds", "repeats", "words"),
    [
        (("dark",), 1, ["No photon-transfer curve", "No fixed pattern of flats"]),
        (("flat",), 2, ["No dark-current line", "No fixed pattern of darks"]),
        (("dark", "flat"), 2, []),
    ],
)
def test_what_is_missing_is_said(kinds, repeats, words):
    shown = drawn(frames_of(SENSOR, captures(kinds, repeats)), Model(SENSOR), 1)
    missing = found_in(shown, Model(SENSOR)).missing
    assert [text.partition(":")[0] for text in missing] == words


def test_scenes_have_none():
    shown = drawn(frames_of(SENSOR, [capture_of(group="report")]), Model(SENSOR), 1)
    assert found_in(shown, Model(SENSOR)) is None


def sums_of(shown, before, after):
    sums = []
    for frame in shown:
        assert is_uniform(frame)
        sums.append(PatternSums(frame, SENSOR.cfa))
        sums[-1].add(frame, predict(before, frame), predict(after, frame))
    return sums


def test_patterns_are_what_frames_have_in_common(frames):
    columns = np.zeros((1, 1, 96))
    columns[..., 20] = 0.002
    shown = drawn(frames, Model(SENSOR), 2, columns)
    after = model_of(SENSOR, exposure=[0.1])
    dark, flat = patterns_of(sums_of(shown, Model(SENSOR), after))
    assert (dark.kind, dark.frames, dark.shape) == ("dark", 4, (64, 96))
    assert dark.columns_before[20] == pytest.approx(0.002 * RANGE, abs=2)
    others = np.delete(dark.columns_before, 20)
    assert np.nanmax(np.abs(others)) < 4 * 10 / np.sqrt(4 * 56)
    assert np.isnan(dark.rows_before[0]) and np.isfinite(dark.rows_before[30])
    assert dark.rows_before[30] == pytest.approx(0.002 * RANGE / 88, abs=2)
    assert dark.before == pytest.approx(dark.after, nan_ok=True)
    # A model that is too bright leaves that much less.
    lit = [frame for frame in shown if frame.capture.kind == "flat"]
    more = [
        ((predict(after, f).mean - predict(Model(SENSOR), f).mean) * f.range)[f.keep]
        for f in lit
    ]
    brighter = np.nanmean(flat.before - flat.after)
    assert brighter == pytest.approx(np.mean(more), rel=0.01) and brighter > 300


def test_one_hot_pixel_is_no_column(frames):
    shown = drawn(frames[:1], Model(SENSOR), 2)
    signal = shown[0].signal.copy()
    signal[0, 30, 40] = 0.9
    [clean], [hot] = (
        patterns_of(sums_of(f, Model(SENSOR), Model(SENSOR)))
        for f in (shown, [replace(shown[0], signal=signal)])
    )
    step = hot.columns_before[40] - clean.columns_before[40]
    assert 0 < step < 0.05 * 0.9 * RANGE / 56


def test_cells_are_means_of_their_pixels():
    """A frame of 600 px has cells of 4, as no cell may part a CFA's repeat."""
    capture = capture_of("dark", shape=(40, 600), group="report")
    [frame] = drawn(frames_of(SENSOR, [capture]), Model(SENSOR), 4)
    [pattern] = patterns_of(sums_of([frame], Model(SENSOR), Model(SENSOR)))
    assert pattern.before.shape == (10, 150)
    residual = (frame.signal[0] * frame.range)[12:16, 100:104]
    assert pattern.before[3, 25] == pytest.approx(residual.mean(), abs=1e-6)
