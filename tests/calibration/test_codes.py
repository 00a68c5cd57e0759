# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How a frame was quantised shows in the codes that it has."""

import numpy as np
import pytest
from scipy.special import ndtr

from cg2raw.calibration import codes


def counts_of(values):
    """Return how many values have each DN, of values rounded and cut off at 0."""
    rounded = np.maximum(np.rint(values), 0).astype(np.int64)
    return np.bincount(rounded.ravel())


def noise(sigma, size=100_000, seed=1):
    """Return normal noise around 64.3 DN."""
    return np.random.default_rng(seed).normal(64.3, sigma, size)


def picture(seed=1):
    """Return greys of a picture, 0 to 4000 DN, with noise of 4 DN."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 4000, 200_000) + rng.normal(0, 4, 200_000)


@pytest.mark.parametrize(
    ("values", "step", "missing"),
    [
        (np.arange(1000), 1, 0.0),
        (np.arange(0, 4000, 4), 4, 0.0),
        (np.arange(1000)[np.arange(1000) % 4 != 3], 1, 0.25),
        (np.full(1000, 7), 1, 0.0),
        (np.rint(noise(3) / 16) * 16, 1, 0.0),  # two codes alone tell no step
        (np.rint(noise(12) / 16) * 16, 16, 0.0),
    ],
)
def test_a_comb_is_seen(values, step, missing):
    found = codes.comb(counts_of(np.repeat(values, 3)))
    assert found[0] == step and found[1] == pytest.approx(missing, abs=0.01)


# Codes 1 to 3, 6 and 7 never occur, as in a dark of a real camera.
MISSING = np.array([0, 0, 4, 4, 4, 5, 8, 8, *range(8, 200)])


@pytest.mark.parametrize(
    ("values", "least", "most"),
    [
        (MISSING[np.maximum(np.rint(noise(2.5) - 62), 0).astype(int)], 0.3, 0.6),
        (np.floor(picture()) // 8 * 8 + np.floor(picture()) % 5, 0.36, 0.38),
        (noise(0.3), 0, 0),
        (noise(2.5), 0, 0),
        (picture(), 0, 0),
        (np.concatenate([noise(1), noise(1) + 40]), 0, 0),  # two greys of a chart
    ],
)
def test_missing_codes(values, least, most):
    assert least <= codes.gaps(counts_of(values)) <= most


@pytest.mark.parametrize("seed", range(200))
def test_chance_leaves_no_gap_and_no_isolated_code(seed):
    counts = counts_of(np.random.default_rng(seed).normal(30, 4, 2000))
    assert codes.gaps(counts) == 0 and codes.isolated(counts) == 0


@pytest.mark.parametrize(
    ("values", "alone"),
    [
        (np.rint(noise(3) / 16) * 16, 1.0),
        (
            4000 * (np.rint(255 * (picture() / 4000).clip(0, 1) ** 0.45) / 255) ** 2.2,
            0.9,
        ),
        (noise(0.35), 0.0),
        (picture(), 0.0),
        (noise(0.35) - 64.3, 0.0),  # most at 0, which the ADC cuts off
    ],
)
def test_codes_without_neighbours(values, alone):
    assert codes.isolated(counts_of(values)) == pytest.approx(alone, abs=0.1)


@pytest.mark.parametrize(
    ("values", "piles"),
    [
        (np.minimum(picture(), 255), True),
        (picture() / 4000 * 255, False),
        (np.minimum(picture(), 256), False),
        (np.minimum(noise(20) + 150, 255), True),
        (noise(2), False),
    ],
)
def test_white_of_eight_bits(values, piles):
    assert codes.piles_up_at_byte(counts_of(values)) == piles


@pytest.mark.parametrize("mean", [64.0, 64.25, 64.5])
@pytest.mark.parametrize("hot", [0, 300])
@pytest.mark.parametrize(("sigma", "coarse"), [(0.35, True), (0.5, False), (3, False)])
def test_noise_below_half_a_dn(mean, hot, sigma, coarse):
    rng = np.random.default_rng(3)
    dark = np.rint(rng.normal(mean, sigma, (200, 300))).astype(np.uint16)
    dark.ravel()[rng.choice(dark.size, hot, replace=False)] += 50
    assert codes.is_coarse(dark, 2) == coarse


@pytest.mark.parametrize("mean", [64, 64.5])
def test_chance_makes_no_noise_coarse(mean):
    """At half a DN exactly, in 400 frames; once in 3 million it may."""
    rng = np.random.default_rng(4)
    darks = np.rint(rng.normal(mean, 0.5, (400, 48, 64))).astype(np.uint16)
    assert not any(codes.is_coarse(dark, 2) for dark in darks)


@pytest.mark.parametrize("sigma", [0.4, 0.5, 0.7])
@pytest.mark.parametrize("mean", [7.0, 7.2, 7.5])
def test_rounding_adds_more_or_less_by_where_the_mean_lies(sigma, mean):
    """Within a quarter of the wave, or 1 % of the variance."""
    edges = np.arange(20) + 0.5
    shares = np.diff(ndtr((edges - mean) / sigma))
    variance = np.array(np.average((edges[1:] - 0.5 - mean) ** 2, weights=shares))
    wave = codes.wave_of_rounding(variance, np.array(mean), np.array(0.0))
    own = variance - wave - codes.ROUNDING
    assert own == pytest.approx(sigma**2, abs=0.25 * abs(wave) + 0.01 * sigma**2)
