# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Tails of the temporal noise without light, by differences of two darks.

Source: K. Wei et al., IEEE Trans. PAMI 44(11), 2022 (Tukey lambda)."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import tukeylambda

from cg2raw.calibration.measured import Measured
from cg2raw.calibration.robust import Array
from cg2raw.calibration.seen import Seen
from cg2raw.statistics.constant import BINS_PER_SIGMA

FOURTH_OF_ROUNDING = -1.2  # its fourth cumulant, of the square of its variance
LEAST_NOISE = 12.0  # variance, of that of rounding, which shapes the tails below it
# Excess kurtosis that pixels bring whose variances differ by a quarter: 3 times 0.25^2.
TAILS_FLOOR = 0.19
HISTOGRAM = np.linspace(-8, 8, 129)  # edges, standard deviations of the difference
LEAST_LAMBDA = -0.2  # of Tukey's distribution; at -0.25 its kurtosis has no bound


@dataclass(frozen=True)
class Tails:
    """excess_kurtosis : 0 of a normal distribution; None where rounding shapes it.
    tukey_lambda : of that kurtosis. histogram : of differences of two of @frames darks
    (HISTOGRAM). variance : (sites, blocks) DN^2 of a pixel, and error : (blocks,), the
    relative one of their mean."""

    excess_kurtosis: Measured | None
    tukey_lambda: float | None
    histogram: Array
    frames: int
    variance: Array
    error: Array

    @property
    def are_heavy(self) -> bool:
        """Whether the distribution is not the normal one, beyond the floor."""
        k = self.excess_kurtosis
        return k is not None and k.stands_out and abs(k.value) > TAILS_FLOOR


def tails_of(seen: Seen, number: int) -> Tails:
    """Return the tails of a group of several darks of one exposure."""
    noise, planes = seen.noise(number), seen.statistics.planes
    fourth = float(np.mean([plane.fourth[number] for plane in planes]))
    many = float(noise.pixels.sum()) * noise.pairs
    total = float(noise.site_variance.mean())
    kurtosis = _kurtosis(fourth - 3, total, many, seen.sites.rounding)
    in_blocks = np.maximum(noise.pixels.sum(0), 1)
    return Tails(
        kurtosis,
        None if kurtosis is None else lambda_of(kurtosis.value),
        signed_histogram(sum(plane.residuals[number] for plane in planes)),
        int(seen.statistics.frames[number]),
        noise.variance,
        np.sqrt(2 / (in_blocks * noise.pairs)),
    )


def signed_histogram(residuals: Array) -> Array:
    """Return how often a residual is between the edges of HISTOGRAM, by the counts of
    its size."""
    width = int(round((HISTOGRAM[1] - HISTOGRAM[0]) * BINS_PER_SIGMA))
    half = residuals[: len(HISTOGRAM) // 2 * width].reshape(-1, width).sum(1) / 2
    return np.concatenate([half[::-1], half])


def _kurtosis(
    of_difference: float, variance: float, pixels: float, rounding: float
) -> Measured | None:
    """Return the excess kurtosis of one frame; None where rounding shapes the tails.

    Cumulants add up: a difference of two has half the excess kurtosis of one, and
    rounding to codes, where noise spreads over them, adds its own. pixels : of all
    differences."""
    if variance < LEAST_NOISE * rounding:
        return None
    fourth = FOURTH_OF_ROUNDING * rounding**2
    inner = variance - rounding
    value = (2 * of_difference * variance**2 - fourth) / inner**2
    return Measured(value, 2 * math.sqrt(24 / pixels), "1")


def lambda_of(excess_kurtosis: float) -> float:
    """Return the lambda, LEAST_LAMBDA to 0.5, of Tukey's law with such tails."""
    grid = np.linspace(LEAST_LAMBDA, 0.5, 701)
    found = tukeylambda.stats(grid, moments="k")
    return float(np.interp(-excess_kurtosis, -found, grid))
