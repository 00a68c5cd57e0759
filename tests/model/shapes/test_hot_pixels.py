# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hot pixels of two splits: planted ones, and what looks like them in one split."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.model.fit import fit
from cg2raw.model.shapes import shapes
from cg2raw.model.shapes.base import Shown
from cg2raw.statistics.constant import DarkRates
from model.shapes.planted import SHAPE, darks, shown, statistics_of

LEAST = np.log(33 / 0.01)


def found(per_second, **more):
    """Return the shapes of darks with such rates, DN/s, of both splits."""
    return shown(lambda n, split: darks(n, split, per_second[n], **more))


def hot(share, seed=5):
    rng = np.random.default_rng(seed)
    return (rng.random(SHAPE) < share) * rng.exponential(30.0, SHAPE)


@pytest.mark.parametrize("seconds", [4.0, 40.0])
def test_planted_ones_are_found(seconds):
    """A share and a mean rate within 3.5 standard errors, for charges of any time."""
    rates = hot(0.004) * 4 / seconds
    shape = found([rates] * 2, times=(0.0, seconds)).found["hot_pixels"]
    assert shape.nats > 10 * LEAST
    for figure, planted in zip(shape.figures, (0.004, 120 / seconds), strict=True):
        assert abs(figure.value - planted) < 3.5 * figure.standard_error, figure


def test_others_in_each_split_are_none():
    """As many cosmic rays in single frames: the pixels are others each time."""
    rates = [hot(0.004, seed) for seed in (5, 6)]
    shape = found(rates, frames=1, singles=True).found["hot_pixels"]
    assert shape.nats < LEAST


@pytest.mark.parametrize("log_sigma", [0.0, 0.9])
def test_law_of_the_others(log_sigma):
    """Its median is measured below the mean, which the line of levels has; no pixel of
    its tail is hot."""
    rng = np.random.default_rng(7)
    law = 2.0 * np.exp(log_sigma * rng.standard_normal(SHAPE)) * (log_sigma > 0)
    both = found([law] * 2)
    assert both.found["hot_pixels"].nats < LEAST
    median, error = both.dark_median
    masked = statistics_of(darks(0, "training", law)).masked(SHAPE)
    truth = np.median(law) - law[~masked].mean()
    assert abs(median - truth) <= 3 * error
    assert error <= 0.1 * abs(truth)


def test_a_rate_s_noise_grows_with_its_charge():
    """Of a slope from one bias of 2 DN noise to the mean of four darks of 10 s, drawn
    for pixels of 20 times that noise."""
    read, time, frames, gain = 2.0, 10.0, 4, 0.5
    noise = read * np.sqrt(1 + 1 / frames) / time
    rate, rng = 20 * noise, np.random.default_rng(8)
    levels = gain * rng.poisson(rate * time / gain, (frames, 100_000))
    levels = levels + read * rng.standard_normal(levels.shape)
    measured = (levels.mean(axis=0) - read * rng.standard_normal(100_000)) / time
    rates = DarkRates("", np.zeros(0, int), noise, 1 / time / frames)
    grown = 1 + 20 * Shown.shot(SimpleNamespace(gain=lambda _: gain), rates)
    assert measured.var() / noise**2 == pytest.approx(grown, rel=0.02)
    assert grown > 1.5


def test_one_exposure_time_shows_no_rates():
    statistics = statistics_of(darks(0, "training", hot(0.01), times=(0.0,)))
    only = fit(statistics)
    assert (
        "hot_pixels"
        not in shapes(statistics, ("training", "validation"), (only, only)).found
    )
