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
    statistics, side = shown.statistics, round(len(shown.statistics.planes) ** 0.5)
    groups = np.array(
        [
            g
            for split in splits
            for g, info in enumerate(statistics.groups)
            if info.split == split
        ]
    )
    infos = [statistics.groups[g] for g in groups]
    dark_times = {one.exposure_time or 0.0 for one in infos if one.kind == "dark"}
    times = np.array(
        [[1.0, one.exposure_time or 0.0][: len(dark_times)] for one in infos]
    )
    fits = [shown.fits[shown.splits.index(split)] for split in splits]
    found = []
    for p, plane in enumerate(statistics.planes):
        row, column = divmod(p, side)
        used = plane.masked & samples[row::side, column::side] & ~plane.in_lines
        light = np.concatenate([one.likelihood.planes[p].light for one in fits])
        covariance = plane.products[PIXEL][np.ix_(groups, groups)]
        covariance = covariance / max(plane.freedom[PIXEL], 1.0)
        weights = _weights(light, times, covariance)
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
    at_rows, at_columns, values, each = zip(*found, strict=True)
    return Excess(*map(np.concatenate, (at_rows, at_columns, values, each)))


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
    side = round(len(shown.statistics.planes) ** 0.5)
    planes = shown.statistics.planes
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
