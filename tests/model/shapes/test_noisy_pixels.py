# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Telegraph noise and heavy tails: planted ones, each by its name alone."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import erf, expit

from cg2raw.model.shapes.heavy_tailed_noise import EDGES, Tails, core_of, whole_of
from cg2raw.model.shapes.random_telegraph_noise import NOISY, clumped
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import BINS_PER_SIGMA, PARTS
from model.shapes.planted import (
    NOISE,
    SHAPE,
    TIMES,
    darks,
    normal,
    shown,
    statistics_of,
)
from tiers import slow

LEAST = np.log(33 / 0.01)
NONE = np.zeros(SHAPE)
JUMPING = np.random.default_rng(4).random(SHAPE) < 0.01
STEPS = np.random.default_rng(5).exponential(10 * NOISE, SHAPE) * JUMPING


def jumps(rng, shape):
    """Pixels jump by 10 noises on average, of one state in half of the frames."""
    return normal(rng, shape) + STEPS * (rng.random(shape) < 0.5)


def tails(rng, shape):
    """One draw in 50 has nine times the variance."""
    wide = rng.random(shape) < 0.02
    return normal(rng, shape) * np.where(wide, 3.0, 1.0)


def uneven(rng, shape):
    """The right half has 1.9 times the variance of the left one."""
    return normal(rng, shape) * np.where(np.arange(shape[1]) < 60, 1.0, 1.9**0.5)


def coarse(rng, shape):
    return 0.1 * normal(rng, shape)


@cache
def named(noise, frames, is_hot=False):
    """is_hot : jumping pixels have charge, by darks of other times."""
    rate, times = (400.0 * JUMPING, (2.0, 6.0)) if is_hot else (NONE, TIMES)
    more = {"frames": frames, "noise": noise, "times": times}
    found = shown(lambda n, split: darks(n, split, rate, **more))
    return {name for name, one in found.found.items() if one.nats > LEAST}, found


@pytest.mark.parametrize(
    ("noise", "frames", "names"),
    [
        (normal, 2, set()),
        slow(normal, 8, set()),
        slow(coarse, 2, set()),
        slow(coarse, 8, set()),
        (jumps, 2, {"random_telegraph_noise"}),
        (jumps, 8, {"random_telegraph_noise"}),
        (tails, 2, {"heavy_tailed_noise"}),
        (tails, 8, {"heavy_tailed_noise"}),
    ],
)
def test_each_has_its_name(noise, frames, names):
    assert named(noise, frames)[0] == names


def test_noise_that_is_uneven_has_no_tails():
    assert named(uneven, 32)[0] == set()


@pytest.mark.parametrize("noise", [0.3, 0.45])
def test_how_much_noise_of_few_codes_clumps(noise):
    """Pairs of codes of a million pixels anywhere within a code, that differ by more
    than four standard deviations of a pair."""
    rng = np.random.default_rng(6)
    places = np.repeat((np.arange(32) / 32), 60_000)
    one, two = (
        np.rint(places + noise * rng.standard_normal(len(places))) for _ in "ab"
    )
    power = float(np.mean((one - two) ** 2)) / 2
    far = (np.abs(one - two) >= max(np.floor(NOISY * np.sqrt(2 * power)), 1)).reshape(
        32, -1
    )
    shares = far.mean(axis=1)
    plane = SimpleNamespace(power=np.array([power]))
    statistics = SimpleNamespace(shortest_darks=lambda _: [0], planes=[plane])
    found = clumped(SimpleNamespace(statistics=statistics, splits=("a", "b")))
    assert found == pytest.approx((shares**2).mean() / shares.mean() ** 2, rel=0.1)


def test_hot_pixels_are_not_noisy():
    """Their charge has shot noise, in the shortest darks, too: 14 DN."""
    assert named(normal, 6, is_hot=True)[0] == {"hot_pixels"}


def test_numbers():
    """The share of jumping pixels, of whose steps some are hidden by noise, and their
    mean step, within 3.5 errors; read noise beside them is that of the others. Of
    tails, what they add to the variance is known best."""
    for frames in (2, 8):
        found = named(jumps, frames)[1]
        share, step = found.found["random_telegraph_noise"].figures
        assert abs(share.value - JUMPING.mean()) < 3.5 * share.standard_error
        assert abs(step.value - 10 * NOISE) < 3.5 * step.standard_error
        assert share.standard_error < 0.4 * share.value
        assert step.standard_error < 0.2 * step.value
    value, error = found.cores[0]
    assert abs(value - NOISE**2) < 3.5 * error < 0.1 * NOISE**2
    found = named(tails, 8)[1]
    value, error = found.most[0]  # the noise of most draws
    assert abs(value - NOISE**2) < 3.5 * error < 0.1 * NOISE**2
    tailed = found.found["heavy_tailed_noise"].figures
    share, ratio = (figure.value for figure in tailed)
    assert share * (ratio - 1) == pytest.approx(0.02 * 8, rel=0.2)
    assert ratio == pytest.approx(9.0, rel=0.4)


def test_the_error_of_a_scale_is_that_of_its_information():
    """Fisher's, of shares of a normal law; and no order of numbers is another."""
    tails = Tails(np.zeros(len(EDGES)), 100.0)
    shares, step = tails.shares(1.0, 0.0, 1.0), 1e-3
    moved = tails.shares(np.exp(step), 0.0, 1.0) - tails.shares(np.exp(-step), 0.0, 1.0)
    information = 1e5 * np.sum((moved / (2 * step)) ** 2 / shares)
    found = replace(tails, counts=1e5 * shares).covariance(np.zeros(1))
    assert found == pytest.approx(1 / information, rel=1e-2)
    numbers = np.array([0.0, -4.0, 2.0])
    counts = 1e5 * tails.shares(1.0, expit(-4.0), np.exp(2.0))
    found = replace(tails, counts=counts).covariance(numbers)
    assert found == pytest.approx(found.T, rel=1e-6)


def test_the_variance_of_most_draws_is_that_of_all_without_tails():
    """Of a million residuals by a normal law exactly, of 100 DN^2."""
    shares = np.diff(erf(np.arange(513) / BINS_PER_SIGMA / 2**0.5))
    plane = SimpleNamespace(
        power=np.array([100.0]),
        residuals=1e6 * shares[None],
        freedom=np.full(len(PARTS), 1e6),
    )
    statistics = SimpleNamespace(
        planes=[plane], unmasked=1e6, shortest_darks=lambda split: np.array([0])
    )
    value, error = core_of(SimpleNamespace(statistics=statistics), "first")
    assert value == pytest.approx(100 - ROUNDING, rel=1e-4)
    assert 100 * (2 / 1e6) ** 0.5 < error < 200 * (2 / 1e6) ** 0.5


def test_the_variance_of_all_draws():
    """Of a quarter more variance by tails, in pairs: that of samples that are not
    masked times `whole`, which is off by its standard error."""

    def wide(rng, shape):
        return normal(rng, shape) * np.where(rng.random(shape) < 0.016, 4.2, 1.0)

    truth, away = NOISE**2 * (1 + 0.016 * (4.2**2 - 1)), []
    for seed in range(16):
        drawn = darks(seed, "first", NONE, times=(0.0,), frames=2, noise=wide)
        statistics = statistics_of(drawn)
        whole, error = whole_of(SimpleNamespace(statistics=statistics), "first")
        kept = np.mean([plane.power[0] for plane in statistics.planes]) - ROUNDING
        away.append((kept * whole - truth) / (kept * error))
    assert abs(np.mean(away)) < 1.0
    assert 0.6 < np.std(away) < 1.8
