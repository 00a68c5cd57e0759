# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Offsets that the pixels of a frame and of its rows share: densities are those of
normals with all their covariance, also where the ADC cuts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.frames.frame import frame_of, source_of
from cg2raw.diagnose.frames.tiling import Tiling
from cg2raw.diagnose.inference.coordinate_search import fit_transform
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.whitening import (
    colour_offsets,
    whiten,
    whiten_linearly,
    without_shared,
)
from diagnose.planted import (
    BY_NAME,
    READ,
    capture_of,
    cut_at_zero,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)
from tiers import slow

SENSOR = sensor_of()
BLACK_0 = sensor_of(black_level=[0.0] * 4)
SHAPE = (12, 16)  # too small for a border that does not count
BOTH = {"row_noise": [0.4], "black_level_drift": [0.3]}


def dark(sensor=SENSOR, shape=SHAPE, extra=0.0, number=1):
    captures = [capture_of("dark", number, shape=shape)]
    return drawn(frames_of(sensor, captures), Model(sensor), number, extra)[0]


def tiled(frame, *origins, size):
    """Return the frame in tiles."""
    capture_set = CaptureSet(SENSOR, [frame.capture])
    noise = noise_models(capture_set)[frame.capture.iso]
    tiles = Tiling(frame.tiles.shape, size, 0, np.array(origins, np.int32))
    cut = frame_of(source_of(capture_set, frame.capture), tiles, noise)
    return replace(cut, signal=tiles.cut(frame.signal[0]))


@pytest.mark.parametrize("terms", [{"black_level_drift": [0.3]}, BOTH])
def test_the_density_of_a_frame_is_the_dense_normal(terms):
    """Rows, and what all pixels share: in the order of whitening the second has lost
    what the first took of it."""
    frame = dark()
    frame = replace(frame, keep=np.random.default_rng(1).random((1, *SHAPE)) < 0.8)
    model = model_of(SENSOR, **terms)
    p = predict(model, frame)
    z = (frame.signal - p.mean) / np.sqrt(p.variance)
    white, cost = whiten(z, p, model, frame)
    keep = frame.keep
    found = (-0.5 * white**2 - 0.5 * np.log(2 * np.pi) + cost)[keep].sum()
    rows = np.broadcast_to(np.arange(SHAPE[0])[:, None], SHAPE)[keep[0]]
    unit = frame.beta2.mean() / p.variance[keep].mean()
    shared = terms["black_level_drift"][0] ** 2 * np.ones((rows.size, rows.size))
    shared += terms.get("row_noise", [0.0])[0] ** 2 * (rows[:, None] == rows)
    normal = multivariate_normal(cov=np.eye(rows.size) + unit * shared)
    assert found == pytest.approx(normal.logpdf(z[keep]), abs=1e-8)


def lit_by_a_lamp():
    """Return (model, a dim flat, of which rows differ as much as its pixels, its
    covariance in standard deviations of the pixels that count)."""
    amplitude, period = 0.4, 7.0
    [frame] = frames_of(SENSOR, [capture_of("flat", 3, shape=SHAPE, level=0.02)])
    frame = drawn([frame], Model(SENSOR), 3)[0]
    frame = replace(frame, keep=np.random.default_rng(1).random((1, *SHAPE)) < 0.8)
    model = model_of(SENSOR, **BOTH, mains_flicker=[amplitude, period])
    p = predict(model, frame)
    keep, spread = frame.keep, np.sqrt(p.variance)
    at = np.broadcast_to(np.arange(SHAPE[0])[:, None], SHAPE)[keep[0]]
    turns = 2 * np.pi * (at[:, None] - at) / period
    light = p.exposed[keep]
    shared = 0.5 * amplitude**2 * np.outer(light, light) * np.cos(turns)
    offsets = {name: values[0] ** 2 for name, values in BOTH.items()}
    read = frame.beta2.mean()
    shared += read * offsets["black_level_drift"]
    shared += read * offsets["row_noise"] * (at[:, None] == at)
    unit = np.outer(spread[keep], spread[keep])
    return model, frame, np.eye(at.size) + shared / unit


def test_the_wave_of_a_lamp_is_seen_as_rows_and_frame_left_it():
    """The density is that of one normal with the covariance of all three."""
    model, frame, covariance = lit_by_a_lamp()
    p = predict(model, frame)
    z = (frame.signal - p.mean) / np.sqrt(p.variance)
    white, cost = whiten(z, p, model, frame)
    found = (-0.5 * white**2 - 0.5 * np.log(2 * np.pi) + cost)[frame.keep].sum()
    normal = multivariate_normal(cov=covariance)
    assert found == pytest.approx(normal.logpdf(z[frame.keep]), abs=1e-6)


def test_what_is_most_likely_shared_is_that_of_the_covariance():
    model, frame, covariance = lit_by_a_lamp()
    p, keep = predict(model, frame), frame.keep
    z = np.random.default_rng(5).standard_normal(keep.shape) * keep
    left = 1.0
    for name, values in BOTH.items():
        along = BY_NAME[name].along(p, np.array(values), frame)
        left = left * (1 - BY_NAME[name].leverage(along, frame))
    own = without_shared(z, p, model, frame) * np.sqrt(left)
    assert own[keep] == pytest.approx(np.linalg.solve(covariance, z[keep]), abs=1e-6)


def test_all_tiles_share_the_offset_of_their_frame():
    frame = dark()
    quarters = [(0, 0), (0, 8), (6, 0), (6, 8)]
    tiles = tiled(frame, *quarters, size=(6, 8))
    for terms in ({"black_level_drift": [0.3]}, BOTH):
        model = model_of(SENSOR, **terms)
        whole, parts = (log_density(model, one)[0].sum() for one in (frame, tiles))
        assert parts == pytest.approx(whole, abs=1e-8)


@pytest.mark.parametrize("terms", [{"black_level_drift": [0.3]}, BOTH])
def test_offsets_drop_out_of_scores(terms):
    """The product of a coloured image and a whitened one is theirs."""
    frame, model = dark(), model_of(SENSOR, **terms)
    p = predict(model, frame)
    a, b = np.random.default_rng(2).standard_normal((2, 1, *SHAPE))
    coloured = colour_offsets(a, p, model, frame)
    whitened = whiten_linearly(b, p, model, frame, True)
    assert (coloured * whitened).sum() == pytest.approx((a * b).sum(), abs=1e-9)
    assert (whitened * a).sum() != pytest.approx((a * b).sum(), abs=1e-3)


def integrated(frame, row, drift):
    """Return the log density of a frame, integrated over its offset and those of its
    rows on a grid, offsets in read noises."""
    p = predict(Model(BLACK_0), frame)
    grid, step = np.linspace(-6, 6, 241, retstep=True)
    prior = -0.5 * grid**2 - 0.5 * np.log(2 * np.pi)

    def of_rows(offset):
        moved = replace(p, mean=p.mean + offset * READ)
        return log_density(Model(BLACK_0), frame, moved)[0].sum(-1)[0]

    total = []
    for whole in grid:
        heights = [of_rows(drift * whole)]
        if row:
            heights = [of_rows(drift * whole + row * x) for x in grid]
            heights = [np.logaddexp.reduce(heights + prior[:, None]) + np.log(step)]
        total.append(np.sum(heights))
    return np.logaddexp.reduce(total + prior) + np.log(step)


@pytest.mark.parametrize(("row", "drift"), [(0.0, 0.4), slow(0.5, 0.4)])
def test_where_the_adc_cuts_offsets_are_integrated_out(row, drift):
    """A sixth of the pixels shows the offset only by being low; Laplace's method is as
    exact as for rows, to 0.01 nats a row."""

    def shared(frame, rng):
        rows = row * rng.standard_normal((1, SHAPE[0], 1))
        return READ * (rows + drift * rng.standard_normal())

    (frame,) = cut_at_zero([dark(BLACK_0, extra=shared)], 10.0)
    assert frame.is_cut and 0.02 < frame.at_zero.mean() < 0.8
    terms = {"row_noise": [row]} if row else {}
    model = model_of(BLACK_0, **terms, black_level_drift=[drift])
    found = log_density(model, frame)[0].sum()
    assert found == pytest.approx(integrated(frame, row, drift), abs=0.01 * SHAPE[0])
    assert abs(log_density(Model(BLACK_0), frame)[0].sum() - found) > 0.5


def test_a_few_pixels_at_zero_tell_of_the_frame_s_offset():
    """Each would hide as much as the logarithm of its share changes: 1 nat, here."""
    (frame,) = cut_at_zero([dark(extra=-0.3 * READ, shape=(40, 50))], 27.0)
    assert not frame.is_cut and 0 < (frame.at_zero & frame.keep).sum() < 20
    model = model_of(SENSOR, black_level_drift=[0.3])
    found = log_density(model, frame)[0][frame.keep].sum()
    grid, step = np.linspace(-6, 6, 961, retstep=True)
    p = predict(Model(SENSOR), frame)
    prior = -0.5 * grid**2 - 0.5 * np.log(2 * np.pi)
    heights = [
        log_density(
            Model(SENSOR), frame, replace(p, mean=p.mean + 0.3 * READ * offset)
        )[0][frame.keep].sum()
        for offset in grid
    ]
    wanted = np.logaddexp.reduce(heights + prior) + np.log(step)
    assert found == pytest.approx(wanted, abs=0.02)


def test_without_a_cut_pixel_it_is_the_flow():
    frame = dark(BLACK_0)
    for terms in ({"black_level_drift": [0.3]}, BOTH):
        model = model_of(BLACK_0, **terms)
        cut = replace(frame)
        cut.__dict__["is_cut"] = True
        assert not frame.is_cut and not frame.at_zero.any()
        flow, integral = (log_density(model, one)[0].sum() for one in (frame, cut))
        assert integral == pytest.approx(flow, abs=1e-6)


def darks(count, sigma, seed=0, cut=False, **more):
    """Return darks whose black level drifts."""
    sensor = BLACK_0 if cut else SENSOR
    captures = [capture_of("dark", seed + n, **more) for n in range(count)]

    def drift(frame, rng):
        return sigma * READ * rng.standard_normal()

    made = drawn(frames_of(sensor, captures), Model(sensor), seed, drift)
    return sensor, cut_at_zero(made) if cut else made


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("sigma", [0.1, 0.5])
def test_a_drift_is_recovered_from_few_frames(sigma, cut):
    """Its mean square over 12 sets of 6 frames is that planted: no less by 1/6, as if
    a mean were taken off, nor more. The square of each set has an error of root 2/6; a
    frame of 768 pixels tells its offset to 0.036, less if it is cut."""
    squares = []
    for seed in range(12):
        sensor, frames = darks(6, sigma, 100 * seed, cut, shape=(24, 32))
        start = model_of(sensor, black_level_drift=[0.1])
        found, _ = fit_transform(start, "black_level_drift", on(frames))
        squares.append(found.term("black_level_drift").values[0] ** 2)
    noise = (0.06 if cut else 0.036) ** 2
    error = np.sqrt(2 / 6 / 12) * (sigma**2 + noise)
    assert np.mean(squares) == pytest.approx(sigma**2, abs=3 * error)


def test_a_common_offset_is_the_black_level_s():
    """Beside a black level the drift is about its mean."""
    offset = 3 * READ
    sensor, frames = darks(8, 0.1, shape=(32, 48))
    frames = [replace(one, signal=one.signal + offset) for one in frames]
    start = model_of(sensor, black_level=[0.0] * 4, black_level_drift=[0.1])
    found = fit(start, on(frames))
    level = found.term("black_level").values
    assert level == pytest.approx([offset] * 4, abs=4 * 0.1 / np.sqrt(8) * READ)
    assert 0.05 < found.term("black_level_drift").values[0] < 0.2
    alone = fit(model_of(sensor, black_level_drift=[0.1]), on(frames))
    assert on(frames).total(alone) < on(frames).total(found) - 5
