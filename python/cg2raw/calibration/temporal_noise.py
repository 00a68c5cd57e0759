# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Temporal noise without light: read noise, its tails and neighbours, rows, columns.

Source: EMVA Standard 1288, release 4.0 (temporal dark noise, of differences of frames);
tails: K. Wei et al., IEEE Trans. PAMI 44(11), 2022 (Tukey lambda)."""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.codes import COARSE, ROUNDING
from cg2raw.calibration.measured import Measured, root_of
from cg2raw.calibration.pair_noise import PairNoise, relative_error
from cg2raw.calibration.robust import Array

FOURTH_OF_ROUNDING = -1.2  # its fourth cumulant, of the square of its variance
LEAST_NOISE = 12.0  # variance, of that of rounding, which shapes the tails below it
# Excess kurtosis that pixels bring whose variances differ by a quarter: 3 times 0.25^2.
TAILS_FLOOR = 0.19
LEAST_LAMBDA = -0.2  # of Tukey's distribution; at -0.25 its kurtosis has no bound


@dataclass(frozen=True)
class TemporalNoise:
    """Noise of one frame without light, DN; None where the frames cannot show it.

    read_noise : (sites) standard deviation of pixels, rounding to codes included, rows'
    and columns' own noise and dark current's shot noise not.
    row_noise, column_noise : of offsets of whole rows and columns, anew in each frame.
    row_correlation, column_correlation : with the next pixel of the row, the column.
    excess_kurtosis : 0 of a normal distribution. tukey_lambda : of that kurtosis.
    blocks : variance of a pixel, DN^2, and its relative error, in blocks of the frame.
    histogram : of differences, see pair_noise.HISTOGRAM. frames : how many went in."""

    read_noise: tuple[Measured, ...]
    row_noise: Measured
    column_noise: Measured
    row_correlation: Measured
    column_correlation: Measured
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
    noise: PairNoise,
    pairs: int,
    charge_variance: float,
    rounding: float,
    exposure_time: float | None,
) -> TemporalNoise:
    """Return the noise of the darks of one exposure.

    charge_variance : DN^2, of dark current's shot noise in a pixel of them.
    rounding : DN^2, of rounding to codes."""
    pixels = noise.pixels.sum(1)
    total = noise.site_variance
    read = [
        root_of(
            float(v) - charge_variance, float(v) * relative_error(float(n), pairs), "DN"
        )
        for v, n in zip(total, pixels, strict=True)
    ]
    in_blocks = np.maximum(noise.pixels.sum(0), 1)
    error_of_blocks = np.array([relative_error(float(n), pairs) for n in in_blocks])
    many = float(pixels.sum())
    per_pixel = math.sqrt(1.5 / (many * pairs)) if pairs > 1 else math.sqrt(1 / many)
    along_row = Measured(noise.row_correlation, per_pixel, "1")
    along_column = Measured(noise.column_correlation, per_pixel, "1")
    kurtosis = _kurtosis(noise.kurtosis, float(total.mean()), many, pairs, rounding)
    return TemporalNoise(
        tuple(read),
        line_noise(noise.row, noise.row_correlation, pairs),
        line_noise(noise.column, noise.column_correlation, pairs),
        along_row,
        along_column,
        kurtosis,
        None if kurtosis is None else lambda_of(kurtosis.value),
        noise.histogram,
        (noise.variance.mean(0), error_of_blocks),
        pairs + 1,
        exposure_time,
    )


def line_noise(
    line: tuple[float, float, int], correlation: float, pairs: int
) -> Measured:
    """Return the own noise of rows or columns, DN.

    line : variance of their means, the pixels' share of it, how many they are. Pixels
    that correlate with the next one have another share: (1 + r) / (1 - r) of it."""
    variance, share, count = line
    share *= (1 + correlation) / (1 - correlation)
    error = variance * relative_error(count - 1, pairs)
    return root_of(variance - share, error, "DN")


def _kurtosis(
    of_difference: float, variance: float, pixels: float, pairs: int, rounding: float
) -> Measured | None:
    """Return the excess kurtosis of one frame; None where rounding shapes the tails.

    Cumulants add up: a difference of two has half the excess kurtosis of one, and
    rounding to codes, where noise spreads over them, adds its own."""
    if variance < LEAST_NOISE * rounding:
        return None
    fourth = FOURTH_OF_ROUNDING * rounding**2
    inner = variance - rounding
    value = (2 * of_difference * variance**2 - fourth) / inner**2
    # Pairs that share a frame: fourth powers of their differences correlate by 1/16.
    error = 2 * math.sqrt(24 / pixels * (9 * pairs - 1) / 8) / pairs
    return Measured(value, error, "1")


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
