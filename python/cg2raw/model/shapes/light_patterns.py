# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What pixels of a pattern that is set apart lack of the light, or have more of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.shapes.base import Shown
from cg2raw.statistics.constant import PIXEL, Array


@dataclass(frozen=True)
class Excess:
    """Of pixels of one pattern. rows, columns : (N,) px of the mosaic. values : (N,)
    relative to the light of those around. weights : (N,) one over their variance, by
    noise and by what pixels differ."""

    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    values: Array
    weights: Array

    def where(self, used: NDArray[np.bool_]) -> "Excess":
        """Return that of some of the pixels, (N,) bool."""
        return Excess(
            self.rows[used], self.columns[used], self.values[used], self.weights[used]
        )

    def times(self, profile: Array) -> tuple[float, float]:
        """Return by how much of a profile, (N,), light is in excess, and the standard
        error."""
        weighted = self.weights * profile
        information = float(weighted @ profile)
        return float(weighted @ self.values) / information, information**-0.5


def excess_of(
    shown: Shown, splits: Sequence[str], samples: NDArray[np.bool_]
) -> Excess | None:
    """Return the excess of light of samples (H, W) that are masked, in no masked line;
    None where the frames show none. splits : whose groups tell. Of what pixels differ
    by in darks, as an offset or in time, nothing is light."""
    statistics, side = shown.statistics, shown.statistics.side
    each = [np.flatnonzero(statistics.splits == split) for split in splits]
    groups = np.concatenate(each)
    times = np.array([statistics.groups[g].exposure_time or 0.0 for g in groups])
    dark_times = np.unique(times[~statistics.is_flat[groups]])
    others = np.column_stack([np.ones_like(times), times])[:, : len(dark_times)]
    fits = [shown.fits[shown.splits.index(split)] for split in splits]
    found = []
    for p, plane in enumerate(statistics.planes):
        row, column = divmod(p, side)
        used = plane.masked & samples[row::side, column::side] & ~plane.in_lines
        light = np.concatenate([one.likelihood.planes[p].light for one in fits])
        covariance = plane.products[PIXEL][np.ix_(groups, groups)]
        covariance = covariance / max(plane.freedom[PIXEL], 1.0)
        weights = _weights(light, others, covariance)
        if not used.any() or weights is None:
            continue
        above = plane.outliers[np.ix_(groups, used[plane.masked])]
        rows, columns = np.nonzero(used)
        variance = float(weights @ covariance @ weights)
        found.append(
            (
                rows * side + row,
                columns * side + column,
                weights @ above,
                np.full(len(rows), 1 / variance),
            )
        )
    if not found:
        return None
    return Excess(*map(np.concatenate, zip(*found, strict=True)))


def excesses_of(
    shown: Shown, samples: NDArray[np.bool_]
) -> tuple[Excess, Excess, Excess] | None:
    """Return the excess by the first split, the second, and by both together; None
    where the frames do not show all of them."""
    first, second, both = (
        excess_of(shown, splits, samples)
        for splits in (shown.splits[:1], shown.splits[1:], shown.splits)
    )
    if first is None or second is None or both is None:
        return None
    return first, second, both


def _weights(light: Array, others: Array, covariance: Array) -> Array | None:
    """Return (G,) by which groups add up to the share of light, whatever they have of
    others, (G, k); None where that is not known."""
    if not light.any():
        return None
    design = np.column_stack([light / light.max(), others])
    try:
        weighted = np.linalg.solve(covariance, design)
        found = np.linalg.solve(design.T @ weighted, weighted.T)
    except np.linalg.LinAlgError:
        return None
    of_light: Array = found[0] / light.max()
    return of_light


def frame_shape(shown: Shown) -> tuple[int, int]:
    """Return the height and width of a frame, px."""
    side, planes = shown.statistics.side, shown.statistics.planes
    height = sum(plane.shape[0] for plane in planes[::side])
    return height, sum(plane.shape[1] for plane in planes[:side])


def nats_of(
    trained: tuple[float, float],
    measured: tuple[float, float],
    both: tuple[float, float],
    tried: int,
) -> float:
    """Return minus the logarithm of a bound on the chance that so many patterns have
    one of as large an excess; 0 if it is smaller, and if one split speaks against what
    the other has. Pixels differ alike in both splits, so that one cannot tell whether
    those of the other were chosen by chance: their number does.

    trained, measured, both : value and standard error by the first split, the second,
    and by both together. Source: H. Chernoff, Ann. Math. Stat. 23(4), 1952."""
    if trained[0] * (2 * measured[0] - trained[0]) <= 0:  # less likely than none
        return 0.0
    return max((both[0] / both[1]) ** 2 / 2 - float(np.log(tried)), 0.0)
