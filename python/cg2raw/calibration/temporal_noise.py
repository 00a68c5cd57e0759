# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Temporal noise without light: read noise and its tails.

Source: EMVA Standard 1288, release 4.0 (temporal dark noise, of differences of frames);
tails: K. Wei et al., IEEE Trans. PAMI 44(11), 2022 (Tukey lambda)."""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.measured import Measured, root_of
from cg2raw.calibration.photon_transfer import relative_error
from cg2raw.calibration.repeats import Repeats, Seen
from cg2raw.calibration.robust import Array
from cg2raw.statistics.codes import COARSE, ROUNDING
from cg2raw.statistics.constant import BINS_PER_SIGMA

FOURTH_OF_ROUNDING = -1.2  # its fourth cumulant, of the square of its variance
LEAST_NOISE = 12.0  # variance, of that of rounding, which shapes the tails below it
# Excess kurtosis that pixels bring whose variances differ by a quarter: 3 times 0.25^2.
TAILS_FLOOR = 0.19
HISTOGRAM = np.linspace(-8, 8, 129)  # edges, standard deviations of the difference
LEAST_LAMBDA = -0.2  # of Tukey's distribution; at -0.25 its kurtosis has no bound


@dataclass(frozen=True)
class TemporalNoise:
    """Noise of one frame without light, DN; None where the frames cannot show it.

    read_noise : (sites) standard deviation of pixels, rounding to codes included, rows'
    and columns' own noise and dark current's shot noise not.
    excess_kurtosis : 0 of a normal distribution. tukey_lambda : of that kurtosis.
    blocks : variance of a pixel, DN^2, and its relative error, in blocks of the frame.
    histogram : of differences of two (HISTOGRAM). frames : how many went in."""

    read_noise: tuple[Measured, ...]
    excess_kurtosis: Measured | None
    tukey_lambda: float | None
    histogram: Array
    blocks: tuple[Array, Array]
    frames: int
    exposure_time: float | None

    def is_coarse(self, rounding: float) -> bool:
        """Whether it is mostly rounding, of this variance, DN^2, and its size unknown
        but for an upper limit. Source: EMVA 1288, release 4.0."""
        least = min(m.value**2 for m in self.read_noise)
        return least < COARSE / ROUNDING * rounding

    @property
    def has_tails(self) -> bool:
        """Whether the distribution is not the normal one, beyond the floor."""
        k = self.excess_kurtosis
        return k is not None and k.stands_out and abs(k.value) > TAILS_FLOOR

    @property
    def mean_read_noise(self) -> Measured:
        """Of all sites, DN: the root of their mean variance."""
        variances = [m.value**2 for m in self.read_noise]
        errors = [2 * m.value * m.standard_error for m in self.read_noise]
        return root_of(
            float(np.mean(variances)), float(np.linalg.norm(errors)) / len(errors), "DN"
        )


def temporal_noise(
    seen: Seen, repeats: Repeats, charge_variance: float
) -> TemporalNoise:
    """Return the noise of a group of darks of one exposure.

    charge_variance : DN^2, of dark current's shot noise in a pixel of them."""
    noise = repeats.noise
    assert noise is not None
    rounding, number, pairs = seen.todo.sites.rounding, repeats.number, repeats.pairs
    total = noise.site_variance
    relative = math.sqrt(2 / noise.freedom)
    in_blocks = np.maximum(noise.pixels.sum(0), 1)
    many = float(noise.pixels.sum()) * pairs
    planes = seen.statistics.planes
    fourth = float(np.mean([plane.fourth[number] for plane in planes]))
    kurtosis = _kurtosis(fourth - 3, float(total.mean()), many, rounding)
    return TemporalNoise(
        tuple(
            root_of(float(v) - charge_variance, float(v) * relative, "DN")
            for v in total
        ),
        kurtosis,
        None if kurtosis is None else lambda_of(kurtosis.value),
        signed_histogram(sum(plane.residuals[number] for plane in planes)),
        (
            noise.variance.mean(0),
            np.array([relative_error(float(n), pairs) for n in in_blocks]),
        ),
        repeats.count,
        repeats.group.exposure_time,
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
    """Return the lambda, LEAST_LAMBDA to 0.5, of Tukey's distribution with such tails.

    Source of the moments: B. Joiner, J. Rosenblatt, J. Am. Stat. Assoc. 66, 1971."""
    grid = np.linspace(LEAST_LAMBDA, 0.5, 701)
    grid = grid[np.abs(grid) > 1e-6]
    found = np.array([kurtosis_of(float(x)) for x in grid])
    return float(np.interp(-excess_kurtosis, -found, grid))


def kurtosis_of(shape: float) -> float:
    """Return the excess kurtosis of Tukey's lambda distribution, @shape above -0.25."""

    def gamma(x: float) -> float:
        return math.gamma(x * shape + 1)

    second = (
        2
        / shape**2
        * (1 / (1 + 2 * shape) - gamma(1) ** 2 / gamma(2) / (2 * shape + 1))
    )
    one, three = gamma(1), gamma(3)
    fourth = (
        2
        / shape**4
        / (4 * shape + 1)
        * (1 - 4 * one * three / gamma(4) + 3 * gamma(2) ** 2 / gamma(4))
    )
    return fourth / second**2 - 3
