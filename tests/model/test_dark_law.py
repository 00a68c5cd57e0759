# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The law of dark currents: planted numbers and medians, and none of none."""

import numpy as np
import pytest

from cg2raw.model.dark_law import fitted, median_of, shares_of, slopes_of, with_hot
from cg2raw.statistics.constant import RATE_EDGES

SAMPLES = 60_000


def counts_of(rate, log_sigma, share=0.0, hot=40.0, seed=1):
    """Return a histogram of rates over their noise, whose mean without hot is 0."""
    rng = np.random.default_rng(seed)
    rates = rate * np.exp(log_sigma * rng.standard_normal(SAMPLES))
    rates += rng.standard_normal(SAMPLES) - rates.mean()
    rates += (rng.random(SAMPLES) < share) * rng.exponential(hot, SAMPLES)
    return np.histogram(rates, RATE_EDGES)[0].astype(float)


@pytest.mark.parametrize(
    ("rate", "log_sigma", "share"),
    [(15.0, 0.8, 0.005), (1.0, 1.0, 0.0), (0.5, 0.7, 0.002), (3.0, 0.3, 0.0)],
)
def test_planted_numbers(rate, log_sigma, share):
    """Within 3.5 standard errors."""
    law = fitted(counts_of(rate, log_sigma, share), uneven=True, hot=share > 0)
    shift = rate * (1 - np.exp(log_sigma**2 / 2))
    planted = np.array([shift, rate, log_sigma, share, 40.0])[: 5 if share else 3]
    values = (law.shift, law.rate, law.log_sigma, law.fraction, law.hot_rate)
    off = (np.array(values)[: len(planted)] - planted) / law.errors[: len(planted)]
    assert (np.abs(off) < 3.5).all(), off


@pytest.mark.parametrize(
    ("rate", "log_sigma", "known"),
    [
        (15.0, 0.8, 0.1),
        (1.0, 1.0, 0.1),
        (0.4, 0.7, 0.15),
        (0.5, 0.5, 0.3),
        (0.0, 1.0, 0),
    ],
)
def test_median_below_the_mean(rate, log_sigma, known):
    """Of rates that are narrower than noise it is known less well."""
    median, error = median_of(counts_of(rate, log_sigma, 0.002))
    truth = rate * (1 - np.exp(log_sigma**2 / 2))
    assert abs(median - truth) <= 3.5 * error
    assert error <= known * abs(truth)


@pytest.mark.parametrize("spread", [0.6, 2.4])
@pytest.mark.parametrize("form", [0.7, 1.5, 6.0])
def test_median_of_another_law(spread, form):
    """Of inverse Gaussian rates; of wide ones it is known to a twentieth of what it is
    below the mean, as noise hardly moves it."""
    rng = np.random.default_rng(5)
    rates = rng.wald(1.0, form, 400_000)
    rates *= spread / rates.std()
    seen = rates - rates.mean() + rng.standard_normal(rates.size)
    counts = np.histogram(seen, RATE_EDGES)[0].astype(float)
    median, error = median_of(counts)
    truth = np.median(rates) - rates.mean()
    assert abs(median - truth) <= 1.5 * error
    assert error <= (0.06 if spread > 2 else 0.12) * abs(truth)
    if spread > 2:  # the law itself is off by 0.07
        assert median == pytest.approx(truth, rel=0.06)


def test_median_where_codes_are_few():
    """Means of two frames of 0.8 DN noise, which lie half a DN apart."""
    rng = np.random.default_rng(6)
    charge = 2.0 * np.expm1(0.8 * rng.standard_normal(400_000))
    level = 10 + rng.random(charge.size)  # of its row and column
    ends = []
    for mean in (level, level + charge):
        frames = mean + 0.8 * rng.standard_normal((2, mean.size))
        ends.append(np.round(frames).mean(axis=0) - mean + (mean - level))
    noise = np.sqrt(0.8**2 + 1 / 12)
    seen = (ends[1] - ends[0]) / noise
    counts = np.histogram(seen - seen.mean(), RATE_EDGES)[0].astype(float)
    median, error = median_of(counts)
    truth = (np.median(charge) - charge.mean()) / noise
    assert abs(median - truth) <= 2 * error


@pytest.mark.parametrize("shot", [0.0, 0.3])
def test_slopes_are_those_of_the_shares(shot):
    """Against differences of 1e-4, whose square is 1e-8 of what they are of."""
    values = np.array([0.1, 2.0, 0.6, 0.01, 30.0])
    slopes = slopes_of(values, shot, RATE_EDGES)
    for n, slope in enumerate(slopes):
        ends = []
        for sign in (-1, 1):
            moved = values.copy()
            moved[n] = (
                values[0] + sign * 1e-4 if n == 0 else values[n] * np.exp(sign * 1e-4)
            )
            ends.append(shares_of(moved, shot))
        assert slope == pytest.approx((ends[1] - ends[0]) / 2e-4, abs=1e-7)


def test_what_is_hot_is_far_from_the_others():
    """A law with another tail than the log-normal's has no hot pixels."""
    rng = np.random.default_rng(3)
    rates = rng.wald(1.0, 1.5, SAMPLES) * 2 + rng.standard_normal(SAMPLES) - 2
    counts = np.histogram(rates, RATE_EDGES)[0].astype(float)
    both = fitted(counts, uneven=True, hot=True)
    assert both.fraction < 1e-4


def test_many_hot_pixels_are_no_wide_law_of_all():
    """Without hot pixels the widest law is the likeliest, from which a fit with them
    ends far below: 2 % of the pixels of a CCD, in noise of 1.5 times their rate."""
    counts = counts_of(0.65, 0.63, 0.02, hot=29.0)
    law = fitted(counts, uneven=True, hot=True)
    assert law.log_sigma == pytest.approx(0.63, abs=0.1)
    assert law.fraction == pytest.approx(0.02, rel=0.1)


def test_hot_pixels_that_are_known_cost_what_they_are_off():
    """Nothing where they are as stated; half a square of deviations else."""
    counts = counts_of(0.65, 0.63, 0.02, hot=30.0)
    free = fitted(counts, uneven=True, hot=True)
    for rate, least, most in ((30.0, 0.0, 2.0), (15.0, 40.0, 110.0)):
        known = with_hot(counts, 0.0, 0.02, rate)
        assert least <= free.nats - known.nats < most
