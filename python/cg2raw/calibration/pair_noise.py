# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise of repeats: what differs between two frames of one exposure.

In a difference of two frames all fixed patterns cancel; half of its variance is that of
one frame. Source: EMVA Standard 1288, release 4.0, section 8 (temporal noise).
"""

import math
from dataclasses import dataclass

import numpy as np

from cg2raw.calibration.robust import (
    CUT,
    LEAST_SIGMA,
    Array,
    clipped_moments,
    line_means,
)
from cg2raw.calibration.sites import Sites, blocks_of

# Sigma within which tails are looked at: pixels beyond it are cosmic rays or flicker.
TAIL_CUT = 6.0


@dataclass(frozen=True)
class PairNoise:
    """Temporal noise of one frame, DN, from the difference of two.

    variance, pixels : (sites, blocks) of pixels, without rows' and columns' own noise,
    and how many pixels each is of.
    row, column : variance of the means of rows and columns, and their pixels' share of
    it if neighbours did not correlate; each with how many there are.
    row_correlation, column_correlation : with the next pixel of the row, the column.
    kurtosis : excess, of the difference. deviation : (sites,) of all blocks."""

    variance: Array
    pixels: Array
    row: tuple[float, float, int]
    column: tuple[float, float, int]
    row_correlation: float
    column_correlation: float
    kurtosis: float
    histogram: Array

    @property
    def site_variance(self) -> Array:
        """(sites,) DN^2, all blocks together."""
        weights = self.pixels / self.pixels.sum(1, keepdims=True)
        found: Array = (self.variance * weights).sum(1)
        return found


HISTOGRAM = np.linspace(-8, 8, 129)  # edges, standard deviations of the difference


def pair_noise(difference: Array, keep: Array | None, sites: Sites) -> PairNoise:
    """Return the noise of two frames from their difference.

    difference : (H, W) float32 DN; it is altered. keep : (H, W) bool, None for all."""
    first = _subtract_levels(difference, keep, sites)
    least = np.maximum(first, LEAST_SIGMA * sites.step)
    inside = np.abs(difference) <= CUT * sites.spread(least, difference.shape)
    if keep is not None:
        inside &= keep
    lines = []
    for axis in (1, 0):
        means, per_mean, filled = line_means(difference, inside, axis)
        difference -= np.asarray(
            means[:, None] if axis == 1 else means[None], np.float32
        )
        lines.append((means[filled], per_mean))
    variance, pixels = _block_variances(difference, keep, sites, first)
    # Each line's mean has taken its part of the pixels' variance with it.
    variance /= (1 - 1 / lines[0][1]) * (1 - 1 / lines[1][1])
    noise = (variance * pixels).sum(1) / np.maximum(pixels.sum(1), 1)
    shares = [float(noise.mean()) / per_mean for _, per_mean in lines]
    lined = [
        (float(np.var(means, ddof=1)) / 2, share, len(means))
        for (means, _), share in zip(lines, shares, strict=True)
    ]
    z = difference / sites.spread(np.sqrt(2 * np.maximum(noise, 1e-12)), inside.shape)
    if keep is not None:
        z[~keep] = 0
    row, column, kurtosis, counts = _shape_of(z, inside, keep)
    # ... and has made the others of its line anticorrelate by one over their number.
    row, column = row + 1 / lines[0][1], column + 1 / lines[1][1]
    return PairNoise(
        variance, pixels, lined[0], lined[1], row, column, kurtosis, counts
    )


def _subtract_levels(difference: Array, keep: Array | None, sites: Sites) -> Array:
    """Subtract each site's mean, in place; return (sites,) standard deviations."""
    sigmas = []
    kept = [None] * sites.count if keep is None else sites.of(keep)
    for plane, part in zip(sites.of(difference), kept, strict=True):
        used = plane if part is None else plane[part]
        mean, sigma, _ = clipped_moments(used, LEAST_SIGMA * sites.step)
        plane -= np.float32(mean)
        sigmas.append(sigma)
    return np.array(sigmas)


def _block_variances(
    difference: Array, keep: Array | None, sites: Sites, sigmas: Array
) -> tuple[Array, Array]:
    """Return (variance of one frame, pixels), (sites, blocks) each.

    sigmas : (sites,) of the difference, roughly."""
    variance, pixels, least = [], [], LEAST_SIGMA * sites.step
    kept = [None] * sites.count if keep is None else sites.of(keep)
    planes = zip(sites.of(difference), kept, sigmas, strict=True)
    for plane, part, start in planes:
        masks = [None] * 10**4 if part is None else blocks_of(part)
        for block, mask in zip(blocks_of(plane), masks, strict=False):
            used = block if mask is None else block[mask]
            many = used.size > 8
            sigma, count = 0.0, 0
            if many:
                _, sigma, count = clipped_moments(used, least, (0.0, start))
            variance.append(sigma**2 / 2 * count / max(count - 1, 1))
            pixels.append(count)
    shape = sites.count, -1
    return np.reshape(variance, shape), np.reshape(pixels, shape).astype(float)


def _shape_of(
    z: Array, inside: Array, keep: Array | None
) -> tuple[float, float, float, Array]:
    """Return (correlation in the row, in the column, excess kurtosis, histogram).

    z : (H, W) standard deviations, 0 where a pixel does not count; it is altered."""
    counts = np.histogram(z if keep is None else z[keep], HISTOGRAM)[0]
    tails = np.abs(z) <= TAIL_CUT
    if keep is not None:
        tails &= keep
    squares = np.where(tails, z * z, 0)
    many = max(int(np.count_nonzero(tails)), 1)
    second = float(squares.sum(dtype=np.float64)) / many
    fourth = float(np.einsum("ij,ij->", squares, squares, dtype=np.float64)) / many
    z[~inside] = 0
    correlation = []
    for a, b, both in (
        (z[:, :-1], z[:, 1:], inside[:, :-1] & inside[:, 1:]),
        (z[:-1], z[1:], inside[:-1] & inside[1:]),
    ):
        product = float(np.einsum("ij,ij->", a, b, dtype=np.float64))
        correlation.append(product / max(int(np.count_nonzero(both)), 1))
    own = float(np.einsum("ij,ij->", z, z, dtype=np.float64))
    own /= max(int(np.count_nonzero(inside)), 1)
    row, column = (c / max(own, 1e-12) for c in correlation)
    return row, column, fourth / max(second, 1e-12) ** 2 - 3, counts


def pooled(pairs: list[PairNoise]) -> PairNoise:
    """Return the mean over the pairs of one group; counts are of one pair."""

    def mean(name: str) -> Array:
        found: Array = np.mean([getattr(pair, name) for pair in pairs], axis=0)
        return found

    return PairNoise(
        mean("variance"),
        mean("pixels"),
        (*map(float, mean("row")[:2]), pairs[0].row[2]),  # type: ignore[arg-type]
        (*map(float, mean("column")[:2]), pairs[0].column[2]),  # type: ignore[arg-type]
        float(mean("row_correlation")),
        float(mean("column_correlation")),
        float(mean("kurtosis")),
        mean("histogram") * len(pairs),
    )


def relative_error(pixels: float, pairs: int) -> float:
    """Return the standard error of a variance over it, of normal noise.

    pairs : of frames that follow each other: (1, 2), (2, 3) ...; two of them share a
    frame, and the squares of their differences correlate by 1/4."""
    return math.sqrt((3 * pairs - 1) / pixels) / pairs
