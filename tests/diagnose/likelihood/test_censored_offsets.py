# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Row noise that the ADC cuts at 0: its offsets are integrated out."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.frames.frame import frame_of, source_of
from cg2raw.diagnose.frames.tiling import Tiling
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.likelihood.censored_offsets import (
    OffsetVariances,
    censored_offsets,
)
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    READ,
    capture_of,
    cut_at_zero,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of(black_level=[0.0] * 4)
SHAPE = (24, 32)  # too small for a border that does not count


def darks(sigma, seed=1, count=1, shape=SHAPE):
    """Return darks with row noise, nothing of which is cut yet."""

    def rows(frame, rng):
        return sigma * READ * rng.standard_normal((1, shape[0], 1))

    captures = [capture_of("dark", n, shape=shape) for n in range(count)]
    return drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, rows)


def rows_of(p, sigma, frame):
    return censored_offsets(p, OffsetVariances(row=(sigma * READ) ** 2), frame)


def integrated(frame, sigma):
    """Return each row's log density, integrated over its offset on a grid."""
    p = predict(Model(SENSOR), frame)
    offsets, step = np.linspace(-7, 7, 701, retstep=True)  # in standard deviations
    heights = [
        log_density(Model(SENSOR), frame, replace(p, mean=p.mean + x * sigma * READ))[0]
        for x in offsets
    ]
    prior = -0.5 * offsets**2 - 0.5 * np.log(2 * np.pi)
    of_rows = np.sum(heights, -1)[:, 0] + prior[:, None]
    return np.logaddexp.reduce(of_rows) + np.log(step)


@pytest.mark.parametrize("sigma", [0.1, 0.3, 0.7])
@pytest.mark.parametrize("black", [-5.0, 0.0, 10.0])
def test_density_is_that_of_an_integral_over_the_offsets(sigma, black):
    """A read noise has 10 DN: a sixth to two thirds of the pixels are cut."""
    (frame,) = cut_at_zero(darks(sigma), black)
    assert frame.is_cut and 0.1 < frame.at_zero.mean() < 0.8
    found = log_density(model_of(SENSOR, row_noise=[sigma]), frame)[0].sum(-1)[0]
    wanted = integrated(frame, sigma)
    assert found.sum() == pytest.approx(wanted.sum(), abs=0.01 * SHAPE[0])
    assert found == pytest.approx(wanted, abs=0.05)
    without = log_density(Model(SENSOR), frame)[0].sum(-1)[0]
    assert np.abs(without - wanted).sum() > 0.02 * SHAPE[0]


def test_pixels_at_white_do_not_move_their_row():
    (frame,) = cut_at_zero(darks(0.3))
    p = predict(Model(SENSOR), frame)
    white = np.zeros(frame.signal.shape, bool)
    white[0, 5, 3] = white[0, 9, 4:7] = True
    bright = replace(frame, signal=np.where(white, 1.0, frame.signal), at_white=white)
    unseen = replace(frame, keep=frame.keep & ~white)
    found, wanted = (
        rows_of(p, 0.3, one).likeliest.mean - p.mean for one in (bright, unseen)
    )
    assert (found == wanted).all() and np.abs(found).max() > 0.1 * READ


@pytest.mark.parametrize("sigma", [0.1, 0.5, 2.0])
def test_without_a_cut_pixel_it_is_the_flow_of_row_noise(sigma):
    (frame,) = darks(sigma)
    model = model_of(SENSOR, row_noise=[sigma])
    assert not frame.is_cut and not frame.at_zero.any()
    flow = log_density(model, frame)[0].sum(-1)
    cut = replace(frame)
    cut.__dict__["is_cut"] = True
    density, z, p = log_density(model, cut)
    assert density.sum(-1) == pytest.approx(flow, abs=1e-6)
    assert (p.mean != predict(model, frame).mean).all()
    away = z - (frame.signal - p.mean) / np.sqrt(p.variance)  # the same in a row
    assert away == pytest.approx(away[:, :, :1] * np.ones_like(z))


def test_no_row_noise_changes_nothing():
    (frame,) = cut_at_zero(darks(0.0))
    p = predict(Model(SENSOR), frame)
    same = rows_of(p, 0.0, frame)
    assert same.likeliest is p and same.drawn is p and not same.log_density.any()
    nearly = rows_of(p, 1e-4, frame)
    assert nearly.likeliest.mean == pytest.approx(p.mean, abs=1e-5 * READ)
    assert nearly.drawn.mean == pytest.approx(p.mean, abs=1e-3 * READ)
    assert np.abs(nearly.log_density).max() < 1e-6


@pytest.mark.parametrize("sigma", [0.0, 0.15, 0.3, 1.0])
def test_row_noise_that_is_cut_is_recovered(sigma):
    """By 4 darks of 64 rows, each row of which tells sigma to a share of root 2."""
    frames = cut_at_zero(darks(sigma, seed=5, count=4, shape=(64, 96)))
    grid = np.arange(0, sigma + 0.3, 0.02)
    heights = [on(frames).total(model_of(SENSOR, row_noise=[x])) for x in grid]
    assert grid[np.argmax(heights)] == pytest.approx(sigma, rel=0.12, abs=0.05)


def test_likely_offsets_are_those_of_the_rows():
    offsets = 0.5 * READ * np.random.default_rng(3).standard_normal((1, 64, 1))
    (frame,) = frames_of(SENSOR, [capture_of("dark")])
    (frame,) = cut_at_zero(drawn([frame], Model(SENSOR), 6, offsets))
    p = predict(Model(SENSOR), frame)
    found = rows_of(p, 0.5, frame).likeliest.mean - p.mean
    seen = frame.keep.any(-1)
    error = (found[..., :1] - offsets)[seen] / READ
    assert error.std() == pytest.approx(1 / np.sqrt(0.82 * 88), rel=0.25)
    assert (found[~seen] == 0).all()


def tiles_of(frame, *origins):
    """Return a frame of halves of a frame, which begin at row and column."""
    size = SHAPE[0] // (1 + origins[1][0] // 12), SHAPE[1] // (1 + origins[1][1] // 16)
    capture_set = CaptureSet(SENSOR, [frame.capture])
    noise = noise_models(capture_set)[frame.capture.iso]
    tiles = Tiling(SHAPE, size, 0, np.array(origins, np.int32))
    cut = frame_of(source_of(capture_set, frame.capture), tiles, noise)
    shown = {name: tiles.cut(getattr(frame, name)[0]) for name in ("signal", "at_zero")}
    return replace(cut, **shown, at_white=np.zeros(cut.signal.shape, bool))


def test_tiles_beside_each_other_share_their_rows():
    (frame,) = cut_at_zero(darks(0.5))
    p = predict(Model(SENSOR), frame)
    whole = rows_of(p, 0.5, frame)
    halves = tiles_of(frame, (0, 0), (0, 16))
    q = predict(Model(SENSOR), halves)
    beside = rows_of(q, 0.5, halves)
    as_cut = halves.tiles.cut(whole.likeliest.mean[0])
    assert beside.likeliest.mean == pytest.approx(as_cut, rel=1e-9)
    assert beside.log_density.sum() == pytest.approx(whole.log_density.sum())
    away = beside.drawn.mean - beside.likeliest.mean
    assert away[0] == pytest.approx(away[1]) and away[0].std() > 0.05 * READ
    below = tiles_of(frame, (0, 0), (12, 0))
    stacked = rows_of(predict(Model(SENSOR), below), 0.5, below)
    as_cut = below.tiles.cut(whole.likeliest.mean[0])
    assert stacked.likeliest.mean == pytest.approx(as_cut, rel=1e-9)
    assert stacked.log_density.sum() == pytest.approx(whole.log_density.sum())
    assert (stacked.likeliest.mean[0] != stacked.likeliest.mean[1]).all()
