# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor with many departures at once: all are measured, and none is made up."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.full_start import full_start
from cg2raw.diagnose.inference.moments import clipped_variance, moments_of
from cg2raw.diagnose.inference.outliers import outliers
from cg2raw.diagnose.inference.pruning import pruned
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    FULL_WELL,
    ONE,
    READ,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
)
from diagnose.planted import sensor_of as made

SENSOR = made()
TILE = (1, *SHAPE)
READ_FACTOR, LIGHT_FACTOR = 1.4, 1.2  # of the variances
OFFSET, RATE = 3 * READ, 2 * READ  # signal, signal per second
COLUMNS, PIXELS, GAINS = 0.5 * READ, READ, 0.02
THRESHOLD = np.log(20 / 0.01)
UNIFORM = [effect for effect in BY_NAME.values() if effect.measured_by_uniform_frames]
PLANTED = {
    "read_noise",
    "shot_noise",
    "black_level",
    "dark_current",
    "column_fixed_pattern",
    "dsnu",
    "prnu",
}


def captures(group, count=3):
    kinds = [("dark", 0.0, 0.0), ("dark", 4.0, 0.0), ("flat", 1.0, 0.15)]
    kinds.append(("flat", 1.0, 0.5))
    return [
        capture_of(
            kind,
            n,
            name=f"{kind}{seconds:g}_{level:g}_{n}{group}",
            group=group,
            exposure_time=seconds,
            level=level,
        )
        for kind, seconds, level in kinds
        for n in range(count)
    ]


def frames_with(seed, planted=True):
    """Return frames of two groups, of a sensor that departs in seven ways or none."""
    rng = np.random.default_rng([9, seed])
    columns = COLUMNS * rng.standard_normal((1, 1, SHAPE[1]))
    offsets = columns + PIXELS * rng.standard_normal(TILE)
    gains = GAINS * rng.standard_normal(TILE)

    def extra(frame, _):
        return offsets + gains * predict(Model(SENSOR), frame).exposed

    frames = frames_of(SENSOR, captures("fit") + captures("select"))
    if not planted:
        return drawn(frames, Model(SENSOR), seed)
    model = model_of(
        SENSOR,
        read_noise=[np.log(READ_FACTOR)],
        shot_noise=[np.log(LIGHT_FACTOR)],
        black_level=[OFFSET] * 4,
        dark_current=[RATE],
    )
    return drawn(frames, model, seed, extra)


def started(frames):
    splits = Splits(frames, ONE)
    return full_start(Baseline(Model(SENSOR), splits), UNIFORM)


def test_moments_of_noise_forget_fixed_patterns_and_hot_pixels():
    frames = frames_with(1)[: len(captures("fit"))]
    hot = np.random.default_rng(2).random(TILE) < 0.01
    frames = [replace(f, signal=f.signal + np.where(hot, 0.3, 0)) for f in frames]
    moments = moments_of(Model(SENSOR), on(frames))
    assert moments.read == pytest.approx(READ_FACTOR, rel=0.03)
    assert moments.light == pytest.approx(LIGHT_FACTOR, rel=0.03)
    assert moments.offset == pytest.approx(OFFSET, abs=0.15 * READ)
    assert moments.rate == pytest.approx(RATE, abs=0.05 * READ)


def test_without_frames_that_repeat_each_other_there_is_no_start():
    frames = [f for f in frames_with(1) if f.capture.name.endswith("_0fit")]
    assert moments_of(Model(SENSOR), on(frames)).read is None
    assert started(frames) is None


@pytest.mark.parametrize("far", [0.0, 0.01])
def test_a_variance_does_not_see_what_lies_far_out(far):
    rng = np.random.default_rng(3)
    values = rng.standard_normal(200_000)
    values[: int(far * len(values))] += 40
    assert clipped_variance(values) == pytest.approx(1, rel=0.01)


@pytest.mark.slow
def test_all_departures_are_measured_at_once():
    start = started(frames_with(4))
    found = {term.name: term.values for term in start.model.terms}
    assert found["read_noise"] == pytest.approx(np.log(READ_FACTOR), abs=0.03)
    assert found["shot_noise"] == pytest.approx(np.log(LIGHT_FACTOR), abs=0.04)
    # Columns of their own look like an edge of the bias, whose mean is black level.
    assert found["black_level"] == pytest.approx(OFFSET, abs=0.25 * READ)
    assert found["dark_current"] == pytest.approx(RATE, abs=0.05 * READ)
    assert found["column_fixed_pattern"] == pytest.approx(COLUMNS, rel=0.2)
    assert found["dsnu"] == pytest.approx(PIXELS, rel=0.05)
    assert found["prnu"] == pytest.approx(GAINS, rel=0.08)


@pytest.mark.slow
def test_pruning_leaves_what_is_there():
    start = started(frames_with(5))
    left = pruned(start.model, start.splits, THRESHOLD)
    assert set(left.model.names) == set(left.losses) == PLANTED
    assert min(left.losses.values()) > 2 * THRESHOLD
    assert max(left.dropped.values()) < THRESHOLD


@pytest.mark.slow
@pytest.mark.parametrize("seed", [6, 7, 8])
def test_pruning_leaves_nothing_of_a_sensor_that_is_as_its_profile_says(seed):
    start = started(frames_with(seed, planted=False))
    assert pruned(start.model, start.splits, THRESHOLD).model.names == []


def test_cosmic_rays_are_set_aside_and_a_wrong_model_is_not():
    frame = frames_with(9, planted=False)[0]
    hit = np.zeros(TILE, bool)
    hit[0, 20:22, 30:34] = True
    struck = replace(frame, signal=frame.signal + np.where(hit, 0.2, 0))
    assert (outliers(Model(SENSOR), struck, 0.01) == hit).all()
    shifted = replace(frame, signal=frame.signal + 20 * READ)
    assert not outliers(Model(SENSOR), shifted, 0.01).any()


def test_of_a_model_that_is_half_fitted_the_farthest_are_set_aside():
    frame = frames_with(9, planted=False)[0]
    hit = np.zeros(TILE, bool)
    hit[0, 20:22, 30:34] = True
    wrong = frame.signal + 20 * READ + np.where(hit, 0.2, 0)
    far = outliers(Model(SENSOR), replace(frame, signal=wrong), 0.01, trimmed=True)
    assert far[hit].all()
    assert 0.008 < far.sum() / frame.keep.sum() <= 0.01


LONG = 100.0  # s, of one dark that has no repeat
CHARGE, SPREAD = 0.1 * READ, 0.7  # per second: median, and of the log of pixels


def frames_with_one_long_dark(seed):
    """Return frames whose pixels differ in dark current, of which one dark tells more
    than all others together; a cosmic ray hit it."""
    rates = np.random.default_rng([10, seed]).lognormal(np.log(CHARGE), SPREAD, TILE)

    def extra(frame, rng):
        charge = rates * frame.seconds
        noise = np.sqrt(charge / FULL_WELL) * rng.standard_normal(TILE)
        hit = np.zeros(TILE)
        hit[0, 5, 5:9] = 0.5 * (frame.seconds == LONG)
        return charge + noise + hit

    long = capture_of("dark", 99, name="long", group="fit", exposure_time=LONG)
    frames = frames_of(SENSOR, [*captures("fit"), long, *captures("select")])
    model = model_of(SENSOR, read_noise=[np.log(READ_FACTOR)])
    return drawn(frames, model, seed, extra)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
def test_a_frame_that_makes_its_own_map_does_not_say_how_large_noise_is(seed):
    start = started(frames_with_one_long_dark(seed))
    found = {term.name: term.values for term in start.model.terms}
    assert found["read_noise"] == pytest.approx(np.log(READ_FACTOR), abs=0.03)
    assert found["shot_noise"] == pytest.approx(0, abs=0.04)
    # Half of what the law's middle 68 % span.
    spread = CHARGE * np.sinh(SPREAD)
    assert found["dark_current_nonuniformity"] == pytest.approx(spread, rel=0.1)
