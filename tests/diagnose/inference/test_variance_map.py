# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Variance map: pixels that jump are found among repeats, whatever offset they have."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    READ,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    shown,
    tails_of,
)

SENSOR = sensor_of()
SHAPE = (96, 128)
STEP = 10 * READ  # on average
JUMPING = np.zeros(SHAPE, bool)
JUMPING[10::6, 10::6] = True
STEPS = np.where(JUMPING, np.random.default_rng(2).exponential(STEP, SHAPE), 0.0)

OFFSET = np.where(JUMPING, 5 * READ, 0.0)


def darks(count, group="fit"):
    captures = [
        capture_of("dark", 1, name=f"{group}{n}", group=group, shape=SHAPE)
        for n in range(count)
    ]
    return frames_of(SENSOR, captures)


def jumping(frame, rng):
    """Return what jumps add, and an offset of the same pixels that is in all frames."""
    up = rng.random(SHAPE) < 0.5
    return (STEPS * np.where(up, 0.5, -0.5) + OFFSET)[None]


def fitted(frames):
    return fit_patterns(model_of(SENSOR, random_telegraph_noise=[0.0, 0.0]), on(frames))


def test_pixels_that_jump_are_found_in_eight_frames():
    frames = drawn(darks(8), Model(SENSOR), 3, extra=jumping)
    term = fitted(frames).term("random_telegraph_noise")
    sensor_map = term.sensor_map
    known = frames[0].keep[0]
    likely = sensor_map.chance[0] > 0.5
    far = known & (STEPS > 5 * READ)
    assert likely[far].mean() > 0.9, "of 8 states, 1 in 128 are all alike"
    assert likely[known & ~JUMPING].mean() < 1e-3
    count = int((known & JUMPING).sum())
    share, mean = count / known.sum(), STEPS[known & JUMPING].mean()
    assert term.values == pytest.approx([share, mean], rel=3 / np.sqrt(count))
    found = 2 * np.sqrt(sensor_map.mean[0][far & likely])
    # Eight states tell a variance to 27 %, and their spread is least where half are up.
    assert np.median(found / STEPS[far & likely]) == pytest.approx(1, abs=0.2)


def test_offsets_that_repeat_are_no_jumps():
    offset = np.where(JUMPING, 10 * READ, 0.0)[None]
    frames = drawn(darks(6), Model(SENSOR), 4, extra=offset)
    term = fitted(frames).term("random_telegraph_noise")
    assert term.values[0] < 1e-3
    assert term.sensor_map.chance.max() < 0.1


def test_two_frames_say_nothing():
    frames = drawn(darks(2), Model(SENSOR), 5, extra=jumping)
    term = fitted(frames).term("random_telegraph_noise")
    assert not term.values.any() and not term.sensor_map.chance.any()


def test_noise_that_all_pixels_have_more_of_is_no_jump():
    def louder(frame, rng):
        return 0.5 * READ * rng.standard_normal((1, *SHAPE))

    frames = drawn(darks(6), Model(SENSOR), 6, extra=louder)
    assert fitted(frames).term("random_telegraph_noise").values[0] < 2e-3


def test_noise_that_darks_alone_have_more_of_is_no_jump():
    """Four darks that are twice as noisy as the profile says, and eight flats."""

    def louder(frame, rng):
        of_darks = not frame.capture.shows.light
        return of_darks * READ * rng.standard_normal((1, *SHAPE))

    lit = [capture_of("flat", 1, name=f"f{n}", shape=SHAPE) for n in range(8)]
    frames = drawn([*darks(4), *frames_of(SENSOR, lit)], Model(SENSOR), 7, louder)
    assert fitted(frames).term("random_telegraph_noise").values[0] < 2e-3


@pytest.mark.parametrize("count", [4, 10])
def test_tails_of_the_noise_are_no_jumps(count):
    """One residual in thirty is four times as wide."""
    share, ratio = 0.03, 16.0
    core = READ / np.sqrt(1 + share * (ratio - 1))
    rng = np.random.default_rng(count)
    frames = []
    for frame in darks(count):
        wide = rng.random((1, *SHAPE)) < share
        noise = core * rng.standard_normal((1, *SHAPE)) * np.where(wide, 4.0, 1.0)
        frames.append(shown(frame, predict(Model(SENSOR), frame).mean + noise))
    model = model_of(
        SENSOR, heavy_tailed_noise=[share, ratio], random_telegraph_noise=[0.0, 0.0]
    )
    found = fit_patterns(model, on(frames)).term("random_telegraph_noise")
    assert found.values[0] < 2e-3


def test_the_map_makes_other_frames_likelier():
    """A step of 10 read noises costs (10 / 2)^2 / 2 nats where none is expected, and
    about 2 where it is known."""

    def without_offset(frame, rng):
        return jumping(frame, rng) - OFFSET

    model = fitted(drawn(darks(8), Model(SENSOR), 3, extra=jumping))
    (frame,) = drawn(darks(1, "select"), Model(SENSOR), 9, extra=without_offset)
    with_map, bare = (log_density(one, frame)[0] for one in (model, Model(SENSOR)))
    gain, known = (with_map - bare)[0], frame.keep[0]
    assert gain[known & (STEPS > STEP)].mean() > 10
    assert abs(gain[known & ~JUMPING].mean()) < 0.05


@pytest.mark.parametrize("stated", [0.05, 0.2])
def test_tails_that_a_profile_has_too_many_of_are_no_jumps(stated):
    """Nor are they where a profile has four times as many: what it makes less likely of
    all pixels alike says nothing of any."""
    share, ratio = 0.05, 5.3
    silent = model_of(SENSOR, read_noise=[-40.0])
    frames = drawn(darks(12), silent, 5, extra=tails_of(share, ratio))
    model = model_of(
        SENSOR, heavy_tailed_noise=[stated, ratio], random_telegraph_noise=[0.0, 0.0]
    )
    found = fit_patterns(model, on(frames)).term("random_telegraph_noise")
    assert found.values[0] < 0.02


def test_half_of_a_map_stays_that_is_there_already():
    """Or a pixel that rates and jumps explain as well would be of either by turns."""
    frames = on(drawn(darks(8), Model(SENSOR), 3, extra=jumping))
    new = fit_patterns(model_of(SENSOR, random_telegraph_noise=[0.0, 0.0]), frames)
    term = new.term("random_telegraph_noise")
    none = np.zeros_like(term.sensor_map.mean)
    before = replace(term, sensor_map=SensorMap(none, none, chance=none))
    after = fit_patterns(new.with_term(before), frames).term(term.name).sensor_map
    np.testing.assert_allclose(after.chance, term.sensor_map.chance / 2)
    np.testing.assert_allclose(after.mean, term.sensor_map.mean / 2)
