# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Fixed patterns: priors and maps are recovered, and know what they do not know."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.splits import third
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
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


def captures_of(group="fit", count=4, kinds=("dark", "flat"), **more):
    return [
        capture_of(kind, seed, group=group, name=f"{kind}{seed}{group}", **more)
        for kind in kinds
        for seed in range(count)
    ]


def planted(captures, seed, bearing_of, pattern):
    """Return frames that show a pattern; bearing_of(frame) is what multiplies it."""

    def extra(frame, _):
        return bearing_of(frame) * pattern

    return drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, extra)


def white(frame):
    return 1.0


def light(frame):
    return predict(Model(SENSOR), frame).exposed


def fitted(name, frames):
    return fit_patterns(model_of(SENSOR, **{name: [0.0]}), on(frames)).terms[0]


@pytest.mark.parametrize(
    ("name", "sigma", "bearing"), [("prnu", 0.01, light), ("dsnu", READ / 2, white)]
)
def test_a_map_and_its_prior_are_recovered(name, sigma, bearing):
    rng = np.random.default_rng(1)
    pattern = sigma * rng.standard_normal(TILE)
    frames = planted(captures_of(count=8), 2, bearing, pattern)
    term = fitted(name, frames)
    keep = frames[0].keep
    assert term.values[0] == pytest.approx(sigma, rel=0.07)
    error = (term.sensor_map.mean - pattern)[keep]
    doubt = term.sensor_map.variance[keep]
    assert np.mean(error**2 / doubt) == pytest.approx(1, abs=0.08)
    assert doubt.mean() < 0.75 * sigma**2


@pytest.mark.parametrize(("name", "bearing"), [("prnu", light), ("dsnu", white)])
def test_noise_alone_makes_no_map(name, bearing):
    frames = planted(captures_of(count=8), 3, bearing, np.zeros(TILE))
    term = fitted(name, frames)
    alone = READ / 4 if name == "dsnu" else 0.01
    assert term.values[0] < 0.35 * alone
    assert np.abs(term.sensor_map.mean).max() < alone


def test_more_frames_shrink_less():
    rng = np.random.default_rng(4)
    pattern = READ / 2 * rng.standard_normal(TILE)
    shares = []
    for count in (1, 16):
        frames = planted(captures_of(count=count), 5, white, pattern)
        term = fitted("dsnu", frames)
        keep = frames[0].keep
        slope = (term.sensor_map.mean * pattern)[keep].sum() / (pattern**2)[keep].sum()
        shares.append(slope)
    assert shares[0] < 0.5 < 0.75 < shares[1]


def test_slow_maps_are_shading():
    rows, cols = np.mgrid[: SHAPE[0], : SHAPE[1]]
    slow = 0.02 * np.sin(2 * np.pi * cols / SHAPE[1]) * np.ones(TILE)
    frames = planted(captures_of(count=8), 6, light, slow)
    assert fitted("prnu", frames).values[0] < 0.003


def test_columns_are_recovered():
    rng = np.random.default_rng(7)
    sigma = 0.3 * READ
    columns = sigma * rng.standard_normal((1, 1, SHAPE[1]))
    frames = planted(captures_of(count=4), 8, white, columns)
    term = fitted("column_fixed_pattern", frames)
    inner = frames[0].keep.any(1)[0]
    assert term.values[0] == pytest.approx(sigma, rel=0.25)
    error = (term.sensor_map.mean[0, 20] - columns[0, 0])[inner]
    assert error.std() < 0.35 * sigma


@pytest.mark.parametrize("ramp", [0.0, 3.0])
def test_a_ramp_across_columns_is_not_theirs(ramp):
    """It is structure of the bias."""
    sigma, rng = 0.3 * READ, np.random.default_rng(6)
    columns = rng.standard_normal((1, 1, SHAPE[1]))
    across = np.linspace(-0.5, 0.5, SHAPE[1])
    columns -= columns @ across / (across @ across) * across
    pattern = sigma * (columns + ramp * across)
    found = fitted(
        "column_fixed_pattern", planted(captures_of(count=4), 8, white, pattern)
    )
    assert found.values == pytest.approx([sigma], rel=0.15)
    slope = found.sensor_map.mean[0, 20] @ across / (across @ across)
    assert abs(slope) < 0.5 * sigma


def test_a_pixel_far_from_its_column_does_not_move_it():
    """A cosmic ray of one long dark, as a hot pixel's rate would leave it."""
    rng = np.random.default_rng(7)
    sigma = 0.3 * READ
    columns = sigma * rng.standard_normal((1, 1, SHAPE[1]))
    hit = np.zeros(TILE)
    hit[0, 20, 30:34] = -300 * READ
    frames = planted(captures_of(count=4), 8, white, columns + hit)
    term = fitted("column_fixed_pattern", frames)
    assert term.values[0] == pytest.approx(sigma, rel=0.25)
    error = (term.sensor_map.mean[0, 20] - columns[0, 0])[30:34]
    assert np.abs(error).max() < 1.2 * sigma


def test_pixels_that_do_not_count_tell_nothing():
    """Of a frame that is divided by pixels, those of the other groups."""
    rng = np.random.default_rng(12)
    pattern = READ * rng.standard_normal(TILE)
    mask = third(SHAPE, "fit")
    frames = planted(captures_of(mask=lambda: mask), 13, white, pattern)
    whole = capture_of("dark", 50, shape=SHAPE)
    frames += planted([whole], 14, white, pattern)
    term = fitted("dsnu", frames)
    spoilt = [replace(f, signal=np.where(f.keep, f.signal, 0.5)) for f in frames]
    again = fitted("dsnu", spoilt)
    assert (again.sensor_map.mean == term.sensor_map.mean).all()
    assert again.values == term.values
    inside = frames[0].keep
    others = frames[-1].keep & ~inside
    assert (
        term.sensor_map.variance[others].mean()
        > 2 * term.sensor_map.variance[inside].mean()
    )


def test_pixels_that_nobody_saw_have_the_prior():
    rng = np.random.default_rng(15)
    mask = third(SHAPE, "fit")
    pattern = READ * rng.standard_normal(TILE)
    frames = planted(captures_of(mask=lambda: mask, count=8), 16, white, pattern)
    term = fitted("dsnu", frames)
    unseen = ~frames[0].keep
    assert (term.sensor_map.mean[unseen] == 0).all()
    assert term.sensor_map.variance[unseen] == pytest.approx(term.values[0] ** 2)
    assert term.values[0] == pytest.approx(READ, rel=0.08)


def test_pixels_clipped_in_all_frames_do_not_spoil_the_prior():
    rng = np.random.default_rng(17)
    few = rng.random(TILE) < 0.1
    pattern = np.where(few, 6, 0.0) * READ * rng.standard_normal(TILE)
    frames = planted(captures_of(count=8), 18, white, pattern)
    sigma = fitted("dsnu", frames).values[0]
    for frame in frames:
        frame.at_white[:, 20, 20:60] = True
    assert fitted("dsnu", frames).values[0] == pytest.approx(sigma, rel=0.1)


def test_a_map_takes_its_variance_from_fitted_frames_and_adds_it_to_others():
    rng = np.random.default_rng(19)
    pattern = READ * rng.standard_normal(TILE)
    both = captures_of("fit", 3, kinds=("dark",)) + captures_of(
        "select", 3, kinds=("dark",)
    )
    frames = planted(both, 20, white, pattern)
    model = fit_patterns(model_of(SENSOR, dsnu=[0.0]), on(frames[:3]))
    for frame in frames:
        p = predict(model, frame)
        z = ((frame.signal - p.mean) / np.sqrt(p.variance))[frame.keep]
        assert np.mean(z**2) == pytest.approx(1, abs=0.06), frame.capture.group


MAPS = [one.name for one in BY_NAME.values() if isinstance(one, FixedPattern)]


@pytest.mark.parametrize("name", MAPS)
def test_maps_of_other_tiles_are_made_anew(name):
    """What a fit of a few tiles knew of a sensor is where whole frames begin."""
    other = SHAPE[1], SHAPE[0]
    small, large = (
        drawn(frames_of(SENSOR, captures_of(count=3, shape=shape)), Model(SENSOR), 5)
        for shape in (SHAPE, other)
    )
    model = fit_patterns(model_of(SENSOR, **{name: [0.0]}), on(small))
    again = fit_patterns(model, on(large)).term(name).sensor_map
    assert again.mean.shape == (1, *other)
