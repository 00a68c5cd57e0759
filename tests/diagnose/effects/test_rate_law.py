# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is known of pixels that no frame shows: the law of their rates, and residuals
that are normal scores by it."""

import numpy as np
import pytest
from scipy.stats import kstest

from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.inference.log_normal_law import LogNormal

UNEVEN = LogNormal(0.0, 2.0, 0.8)
FEW = RateLaw.of_few(0.03, 40.0)
LAWS = {
    "few are hot": FEW,
    "all differ": UNEVEN.rate_law,
    "both": RateLaw.together([UNEVEN.rate_law, FEW]),
}


def moments(law):
    mean = law.weights @ law.means
    return mean, law.weights @ (law.variances + law.means**2) - mean**2


def drawn(name, count, rng):
    rates = np.zeros(count)
    if name != "few are hot":
        rates += UNEVEN.rate * np.expm1(UNEVEN.log_sigma * rng.standard_normal(count))
    if name != "all differ":
        rates += np.where(rng.random(count) < 0.03, rng.exponential(40.0, count), 0)
    return rates


def test_few_hot_pixels_have_an_exponential_law():
    mean, variance = moments(FEW)
    assert FEW.weights.sum() == pytest.approx(1)
    assert mean == pytest.approx(0.03 * 40)
    assert variance == pytest.approx(0.03 * 2 * 40**2 - (0.03 * 40) ** 2)


def test_rates_of_two_laws_add_up():
    both, parts = moments(LAWS["both"]), [moments(UNEVEN.rate_law), moments(FEW)]
    assert LAWS["both"].weights.sum() == pytest.approx(1)
    assert both == pytest.approx(np.sum(parts, 0))


@pytest.mark.parametrize("width", [0.1, 3.0, 1e9])
def test_a_coarser_law_has_the_same_moments(width):
    law = LAWS["both"].coarser(width)
    assert law.weights.size <= LAWS["both"].weights.size
    assert moments(law) == pytest.approx(moments(LAWS["both"]))


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("seconds", [0.1, 1.0, 10.0])
def test_residuals_of_the_law_become_normal(name, seconds):
    """Of 20,000 pixels with noise of 3, and shot noise of their charge."""
    rng = np.random.default_rng(5)
    rates, gain = drawn(name, 20000, rng), 0.5
    variance = np.full(rates.size, 9.0)
    noise = np.sqrt(variance + gain * seconds * np.maximum(rates, 0))
    residual = seconds * rates + noise * rng.standard_normal(rates.size)
    z, _ = LAWS[name].scores(residual / 3, variance, seconds, gain)
    assert kstest(z, "norm").pvalue > 1e-3
    assert np.abs(z).max() < 6


@pytest.mark.parametrize("name", LAWS)
def test_the_density_by_the_scores_adds_up_to_one(name):
    grid = np.linspace(-10, 2000, 400001)
    ones = np.ones(grid.size)
    z, log_slope = LAWS[name].scores(grid, ones, 1.0, 0.1 * ones)
    density = np.exp(-0.5 * z**2 + log_slope) / np.sqrt(2 * np.pi)
    assert np.trapezoid(density, grid) == pytest.approx(1, abs=2e-3)
