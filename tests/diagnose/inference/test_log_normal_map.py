# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dark current that differs from pixel to pixel: its law and its map are found, beside
hot pixels too, and are none where there is noise alone."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.intervals import estimates
from cg2raw.diagnose.inference.log_normal_law import LogNormal, Rates
from cg2raw.diagnose.inference.log_normal_map import fit_log_normal_map
from cg2raw.diagnose.inference.map_prior import Stated
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
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
NAME = "dark_current_nonuniformity"
TIMES = (0.0, 1.0, 4.0, 4.0)  # seconds: a bias, and darks
LAWS = [(0.5, 0.8), (1.0, 1.2), (0.3, 1.0), (2.0, 0.8)]  # read noises per second, 1


def darks(rates, seed, times=TIMES, group="fit"):
    """Return darks of a sensor whose pixels gather charge at rates, (1, H, W)."""
    captures = [
        capture_of("dark", n, exposure_time=s, shape=SHAPE, group=group)
        for n, s in enumerate(times)
    ]

    def charge(frame, rng):
        mean = frame.seconds * rates
        return mean + np.sqrt(frame.beta1 * mean) * rng.standard_normal(rates.shape)

    return drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, charge)


def rates_of(rate, log_sigma, seed=77, hot=0.0):
    rng = np.random.default_rng(seed)
    rates = rate * READ * np.exp(log_sigma * rng.standard_normal((1, *SHAPE)))
    is_hot = rng.random(rates.shape) < hot
    return rates + is_hot * rng.exponential(20 * READ, rates.shape)


def fitted(frames, rate, *more):
    """Return a model whose dark current is the median, with maps."""
    names = dict.fromkeys((*more, NAME), [0.0])
    model = model_of(SENSOR, dark_current=[rate * READ], **names)
    return fit_patterns(model, on(frames))


@pytest.mark.parametrize(("rate", "log_sigma"), LAWS)
def test_the_law_is_recovered(rate, log_sigma):
    """To a tenth, from 25000 pixels, whose spread is 0.8 to 7 of the noise of the
    longest exposures."""
    model = fitted(darks(rates_of(rate, log_sigma), 1), rate)
    term = model.term(NAME)
    found = term.effect.registry_estimates({}, term.sensor_map)
    assert found["rate"].value == pytest.approx(rate * READ, rel=0.1)
    assert found["log_sigma"].value == pytest.approx(log_sigma, rel=0.1)
    sigma = rate * READ * np.sinh(log_sigma)
    assert term.values[0] == pytest.approx(sigma, rel=0.1)
    low, high = term.effect.interval(term.values[0], term.sensor_map)
    assert low < term.values[0] < high and high - low < 0.2 * sigma


def test_the_likeliest_law_is_the_true_one():
    """Of 12 sensors, on average: within 2.5 standard errors of that, 0.5 to 1.5 %."""
    away = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        true = LogNormal(0.0, 1.0, 0.8)
        rate = true.rate * np.expm1(true.log_sigma * rng.standard_normal((1, *SHAPE)))
        error, shot = np.full(rate.shape, 0.24), np.full(rate.shape, 0.1)
        spread = np.sqrt(error + shot * rate)
        estimate = rate + spread * rng.standard_normal(rate.shape)
        known = np.ones(rate.shape, bool)
        law = fit_log_normal_map(Rates(estimate, error, shot, shot), known).mixture.law
        away.append(np.log([law.rate / true.rate, law.log_sigma / true.log_sigma]))
    error = np.std(away, axis=0) / np.sqrt(len(away))
    assert np.abs(np.mean(away, axis=0) / error).max() < 2.5


def test_slow_pixels_are_no_less_noisy_than_without_charge():
    """Where the mean dark current is below the spread of rates: slow pixels have no
    charge, and the noise of that at most is missing. A law is recovered to 4 %, of
    which 30,000 pixels tell 1 %."""
    rng = np.random.default_rng(17)
    shape, dark, shot, read = (1, 150, 200), 0.1, 0.05, 0.02
    rate = np.expm1(1.1 * rng.standard_normal(shape))
    variance = read + shot * np.maximum(dark + rate, 0)
    estimate = rate + np.sqrt(variance) * rng.standard_normal(shape)
    of_charge = np.full(shape, shot * dark)
    rates = Rates(estimate, read + of_charge, np.full(shape, shot), of_charge)
    np.testing.assert_allclose(rates.error_at(rate), variance)
    known = np.ones(shape, bool)
    found = fit_log_normal_map(rates, known).mixture
    assert found.law.rate == pytest.approx(1, rel=0.04)
    assert found.law.log_sigma == pytest.approx(1.1, rel=0.04)
    stated = {"rate": 1.0, "log_sigma": 1.1}
    law = fit_log_normal_map(rates, known, None, Stated(stated)).mixture.law
    assert (law.rate, law.log_sigma) == (1.0, 1.1)


@pytest.mark.parametrize("seed", [1, 2, 3, 5, 6, 7, 10])
def test_hot_pixels_widen_no_stated_law(seed):
    """A law that is wide enough for them needs none, and is nearly as likely: but it is
    not the profile's, which is, with them."""
    rng = np.random.default_rng(seed)
    shape, stated, noise = (1, 128, 128), {"rate": 0.3, "log_sigma": 1.41}, 0.4
    rate = stated["rate"] * np.exp(stated["log_sigma"] * rng.standard_normal(shape))
    is_hot = rng.random(shape) < 0.004
    rate = rate + is_hot * rng.exponential(20.0, shape)
    estimate = rate + noise * rng.standard_normal(shape)
    rates = Rates(estimate, np.full(shape, noise**2), *np.zeros((2, *shape)))
    found = fit_log_normal_map(
        rates, np.ones(shape, bool), None, Stated(stated)
    ).mixture
    assert found.hot_share == pytest.approx(is_hot.mean(), abs=0.005)
    assert found.hot_share > 0.002
    assert (found.law.rate, found.law.log_sigma) == (0.3, 1.41)


@pytest.mark.slow
def test_intervals_of_the_law_hold_it():
    """Of 12 sensors, 95 % intervals of three numbers each: 36, of which four may miss
    by chance in one run of 26."""
    held = []
    for seed in range(12):
        model = fitted(darks(rates_of(0.5, 0.8, 300 + seed), seed), 0.5)
        law = model.term(NAME).sensor_map.law
        true = {"rate": 0.5 * READ, "log_sigma": 0.8}
        true["sigma"] = true["rate"] * np.sinh(0.8)
        held += [law[n].ci95[0] < value < law[n].ci95[1] for n, value in true.items()]
    assert np.sum(held) >= 32


def test_its_doubt_is_calibrated():
    rates = rates_of(0.5, 0.8)
    frames = darks(rates, 2)
    sensor_map = fitted(frames, 0.5).term(NAME).sensor_map
    keep = frames[0].keep
    error = (sensor_map.mean - (rates - 0.5 * READ))[keep]
    assert np.mean(error**2) == pytest.approx(sensor_map.variance[keep].mean(), rel=0.1)
    assert np.mean(error**2) < 0.2 * rates[keep].var()


def test_the_fit_frames_are_as_likely_as_their_map_lets_them():
    """Residuals of the frames that a map was made of are smaller by its variance, and
    have no mean, by which dark current would move."""
    frames = darks(rates_of(0.5, 0.8), 3)
    model = fitted(frames, 0.5)
    for frame in frames:
        p = predict(model, frame)
        z = ((frame.signal - p.mean) / np.sqrt(p.variance))[frame.keep]
        assert z.var() == pytest.approx(1, abs=0.03)
        assert abs(z.mean()) < 5 / np.sqrt(z.size)
    held = darks(rates_of(0.5, 0.8), 4, (4.0,), "select")[0]
    p = predict(model, held)
    z = ((held.signal - p.mean) / np.sqrt(p.variance))[held.keep]
    assert z.var() == pytest.approx(1, abs=0.04)


@pytest.mark.parametrize("order", [("hot_pixels", NAME), (NAME, "hot_pixels")])
def test_hot_pixels_are_in_one_map_of_two(order):
    """Whichever is fitted first: the maps add up to the truth."""
    rates = rates_of(0.5, 0.8, hot=0.003)
    frames = darks(rates, 5)
    model = model_of(SENSOR, dark_current=[0.5 * READ], **dict.fromkeys(order, [0.0]))
    for _ in range(2):
        model = fit_patterns(model, on(frames))
    law = model.term(NAME).sensor_map.law
    assert law["rate"].value == pytest.approx(0.5 * READ, rel=0.12)
    assert law["log_sigma"].value == pytest.approx(0.8, rel=0.12)
    share = model.term("hot_pixels").values[0]  # with the farthest of the law
    assert share == pytest.approx(0.003, rel=0.4)
    total = sum(term.sensor_map.mean for term in model.terms[1:])
    keep = frames[0].keep
    away = (total - (rates - 0.5 * READ))[keep]
    noise = np.sqrt((READ**2 + 4 * frames[0].beta1.mean() * rates[keep]) / 33)
    assert np.abs(away / noise).max() < 6, "of hot ones that stand out by 200"


def test_both_maps_are_as_sure_of_a_rate_as_they_say():
    """Also of pixels that may be hot or the fastest of the law, with even odds: in
    another frame their residuals are as large as is predicted."""
    rates = rates_of(0.5, 1.1)
    rng = np.random.default_rng(18)
    rates += (rng.random(rates.shape) < 0.02) * rng.exponential(20 * READ, rates.shape)
    model = fitted(darks(rates, 19), 0.5, "hot_pixels")
    assert model.term("hot_pixels").values[0] > 0.003
    held = darks(rates, 20, (4.0,), "select")[0]
    p = predict(model, held)
    z2 = ((held.signal - p.mean) ** 2 / p.variance)[held.keep]
    order = np.argsort(p.mean[held.keep])
    parts = np.array_split(order, 20)
    found = [z2[part].mean() for part in [*parts, *np.array_split(order[-1000:], 4)]]
    assert found == pytest.approx(np.ones(24), abs=0.35)


def test_noise_alone_is_no_map():
    frames = darks(np.zeros((1, *SHAPE)), 6)
    term = fitted(frames, 0.0).term(NAME)
    assert term.values[0] == 0 and not term.sensor_map.mean.any()
    model = Model(SENSOR).with_term(term)
    interval = estimates(model, on(frames))[NAME]["sigma"].ci95
    assert interval == (0, 0)


def test_few_hot_pixels_are_no_law_of_all():
    """Its spread would be far below what frames tell of a pixel."""
    rates = rates_of(0.0, 0.8, hot=0.001)
    frames = darks(rates, 7)
    hot = fit_patterns(model_of(SENSOR, hot_pixels=[0.0]), on(frames))
    uneven = fit_patterns(model_of(SENSOR, **{NAME: [0.0]}), on(frames))
    held = on(darks(rates, 8, group="select"))
    assert held.total(hot) > held.total(uneven) + 20


def test_a_slow_part_is_not_the_pixels():
    """It is a glow, or a gradient: what remains of a slope is 1 % of it."""
    slope = np.broadcast_to(np.linspace(0, 4, SHAPE[1]), (1, *SHAPE)) * READ
    frames = darks(rates_of(1.0, 0.5) + slope, 9)
    sensor_map = fitted(frames, 3.0).term(NAME).sensor_map
    across = sensor_map.mean[0].mean(0)[8:-8]
    found = np.polyfit(np.linspace(0, 4, SHAPE[1])[8:-8], across, 1)[0]
    assert abs(found) < 0.03 * READ


def test_a_hot_pixel_leaves_no_trace_around_it():
    """As a mean of its surroundings would: 1/150 of it, a fifth of a read noise."""
    rates = rates_of(0.5, 0.8)
    rates[0, 40, 40] = 30 * READ
    without = fitted(darks(rates_of(0.5, 0.8), 10), 0.5).term(NAME).sensor_map
    beside = fitted(darks(rates, 10), 0.5).term(NAME).sensor_map
    change = (beside.mean - without.mean)[0, 36:45:2, 36:45:2]
    assert np.abs(np.delete(change.ravel(), 12)).max() < 0.02 * READ


def test_it_is_screened_by_held_out_frames_as_other_maps_are():
    frames = darks(rates_of(0.5, 0.8), 1)
    base = Linearisation(model_of(SENSOR, dark_current=[0.5 * READ]), on(frames))
    assert BY_NAME[NAME].standard_error(1.0, fitted(frames, 0.5).term(NAME).sensor_map)
    assert base.height < on(frames).total(fitted(frames, 0.5))
