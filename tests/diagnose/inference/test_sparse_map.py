# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hot pixels: strong and faint ones are found, and outliers and tails are none."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    FULL_WELL,
    READ,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
SHAPE = (144, 192)
LONG = 4.0  # seconds
STANDS_OUT = 3.0  # standard deviations


def darks(seconds, sensor=SENSOR, group="fit"):
    return frames_of(
        sensor,
        [
            capture_of("dark", n, exposure_time=s, group=group, shape=SHAPE)
            for n, s in enumerate(seconds)
        ],
    )


def leaking(rates):
    """Return what a charge adds that leaks at rates: with its shot noise."""

    def extra(frame, rng):
        charge = frame.seconds * rates
        return charge + np.sqrt(frame.beta1 * charge) * rng.standard_normal(rates.shape)

    return extra


def fitted(frames, sensor=SENSOR, **terms):
    model = model_of(sensor, **terms, hot_pixels=[0.0])
    return fit_patterns(model, on(frames))


def by_threshold(frames):
    """Return the map of pixels that lie 5.5 standard deviations above the others."""
    variance = frames[0].beta2.mean()
    information = sum(frame.seconds**2 for frame in frames) / variance
    score = sum(frame.seconds * frame.signal for frame in frames) / variance
    hot = score / np.sqrt(information) > 5.5
    none = np.zeros(hot.shape)
    return SensorMap(
        np.where(hot, score / information, none), np.where(hot, 1 / information, none)
    )


@dataclass
class Faint:
    """Frames with faint hot pixels, and the model that was fitted to the first."""

    rates: np.ndarray
    read: float
    fit_frames: list
    held_out: list
    model: Model

    @property
    def sensor_map(self):
        return self.model.terms[0].sensor_map


@pytest.fixture(
    scope="module", params=[3.0, 30.0], ids=lambda read: f"read noise {read:g} e-"
)
def faint(request):
    """One long dark, in which a fiftieth of the pixels have an exponential charge of 4
    read noises on average; its shot noise is as large as the read noise, or small."""
    read, rng = request.param / FULL_WELL, np.random.default_rng(1)
    sensor = sensor_of(FULL_WELL, request.param)
    place = rng.random((1, *SHAPE))
    rates = np.where(place < 0.02, rng.exponential(4 * read / LONG, place.shape), 0)
    frames = darks([LONG], sensor) + darks([LONG], sensor, "select")
    shown = drawn(frames, Model(sensor), 2, leaking(rates))
    return Faint(rates, read, shown[:1], shown[1:], fitted(shown[:1], sensor))


def test_the_share_is_that_of_pixels_that_stand_out(faint):
    keep = faint.fit_frames[0].keep
    wanted = (faint.rates * LONG > STANDS_OUT * faint.read)[keep].mean()
    assert faint.model.terms[0].values[0] == pytest.approx(wanted, rel=0.25)


def test_the_map_of_faint_ones_is_better_than_a_threshold(faint):
    hard = by_threshold(faint.fit_frames)
    keep = faint.fit_frames[0].keep
    errors = [
        ((pattern.mean - faint.rates) ** 2)[keep].sum()
        for pattern in (faint.sensor_map, hard)
    ]
    assert errors[0] < 0.7 * errors[1]
    term = replace(faint.model.terms[0], sensor_map=hard)
    heights = [
        on(faint.held_out).total(model)
        for model in (faint.model, faint.model.with_term(term))
    ]
    assert heights[0] > heights[1] + 400


def test_its_doubt_is_calibrated(faint):
    """Of pixels whose charge is doubtful by a tenth of the read noise or more."""
    doubt = faint.sensor_map.variance
    asked = faint.fit_frames[0].keep & (doubt * LONG**2 > (0.1 * faint.read) ** 2)
    square = (faint.rates - faint.sensor_map.mean)[asked] ** 2
    assert asked.sum() > 150
    assert np.mean(square / doubt[asked]) == pytest.approx(1, abs=0.35)


def test_its_doubt_is_the_variance_of_other_frames_alone(faint):
    sure = SensorMap(faint.sensor_map.mean, np.zeros(faint.sensor_map.mean.shape))
    without = faint.model.with_term(replace(faint.model.terms[0], sensor_map=sure))
    own, others = (
        on(frames).total(faint.model) - on(frames).total(without)
        for frames in (faint.fit_frames, faint.held_out)
    )
    assert own == 0 and others > 50


def test_hot_pixels_are_found_and_no_others():
    rng = np.random.default_rng(9)
    hot = rng.random((1, *SHAPE)) < 0.004
    rates = np.where(hot, rng.uniform(0.01, 0.1, hot.shape), 0)
    frames = drawn(darks((0.5, 1, 2, 2)), Model(SENSOR), 10, leaking(rates))
    (term,) = fitted(frames).terms
    keep = frames[0].keep
    assert ((term.sensor_map.mean > READ) == hot)[keep].all()
    assert term.sensor_map.mean[hot & keep] == pytest.approx(rates[hot & keep], rel=0.1)
    assert term.values[0] == pytest.approx(hot[keep].mean(), rel=0.02)


@pytest.mark.parametrize(("count", "size"), [(6, 8), (6, 18), (2, 18), (2, 200)])
def test_an_outlier_in_one_of_several_darks_is_no_hot_pixel(count, size):
    frames = drawn(darks([1] * count), Model(SENSOR), 11)
    frames[0].signal[0, 30, 40] += size * READ
    (term,) = fitted(frames).terms
    assert term.sensor_map.mean[0, 30, 40] == 0
    for frame in frames[1:]:
        frame.signal[0, 30, 40] += size * READ
    assert fitted(frames).terms[0].sensor_map.mean[0, 30, 40] > 0.8 * size * READ


def test_noise_alone_has_hardly_any():
    frames = drawn(darks([1, LONG, LONG]), Model(SENSOR), 12)
    (term,) = fitted(frames).terms
    assert term.values[0] < 1e-4
    assert term.sensor_map.mean.sum() < 1e-4 * READ * term.sensor_map.mean.size


def test_heavy_tails_that_the_model_has_are_no_hot_pixels():
    """A twentieth of the read noise has 16 times the variance of the rest."""
    share, ratio = 0.05, 16.0
    core = 1 / (1 + share * (ratio - 1))

    def tails(frame, rng):
        wide = rng.random(frame.signal.shape) < share
        deviation = np.sqrt((ratio - 1) * core * frame.beta2) * wide
        return deviation * rng.standard_normal(wide.shape)

    quiet = model_of(SENSOR, read_noise=[np.log(core)])
    frames = drawn(darks([LONG]), quiet, 13, tails)
    known = fitted(frames, heavy_tailed_noise=[share, ratio])
    shares = [m.term("hot_pixels").values[0] for m in (known, fitted(frames))]
    assert shares[0] < 0.05 * shares[1]
    assert shares[1] > 2e-3


@pytest.mark.parametrize("why", ["masked", "at zero"])
def test_pixels_that_tell_nothing_have_no_map(why):
    frames = drawn(darks([1, LONG]), Model(SENSOR), 14)
    for frame in frames:
        (frame.keep if why == "masked" else frame.at_zero)[:] = why != "masked"
    model = fitted(frames)
    (term,) = model.terms
    assert term.values == 0 and not term.sensor_map.mean.any()
    assert np.isfinite(predict(model, frames[0]).variance).all()


def test_what_a_hot_pixel_leaves_in_biases_is_no_contradiction():
    """Charge that gathers while a frame is read: an offset, and no rate."""
    rates = np.zeros((1, *SHAPE))
    rates[0, 40:44, 60:64] = 300 * READ
    frames = darks((0.0, 0.0, 0.0, LONG))

    def extra(frame, rng):
        offset = 15 * READ * (rates > 0)
        return offset + leaking(rates)(frame, rng)

    found = fitted(drawn(frames, Model(SENSOR), 4, extra)).term("hot_pixels")
    mean = found.sensor_map.mean[rates > 0]
    assert mean == pytest.approx(300 * READ, rel=0.1)


def test_a_pixel_that_the_adc_cuts_at_0_in_long_darks_is_not_hot():
    """It jumped up in two short darks; at a rate that explains these, it would stand
    far up in the long ones."""
    black = sensor_of(black_level=[2.0] * 4)
    frames = drawn(darks((0.04, 0.04, LONG, LONG), black), Model(black), 5)
    place = (0, 20, 30)
    hit = []
    for frame in frames:
        signal, at_zero = frame.signal.copy(), frame.at_zero.copy()
        short = frame.seconds < 1
        signal[place] = 20 * READ if short else -2 / frame.range.flat[0]
        at_zero[place] = not short
        hit.append(replace(frame, signal=signal, at_zero=at_zero))
    [term] = fitted(hit, black).terms
    assert term.sensor_map.mean[place] == 0
