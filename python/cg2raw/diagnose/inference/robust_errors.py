# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Robust errors: how far values are off where a model is not quite right.

Fisher's information says how far noise moves them. What no effect describes, as a
vignetting that is no polynomial, lies where it lies in all frames, and moves them
further: its scores do not average out as those of noise do. Neighbours count together.
Source: H. White, Econometrica 50(1), 1982; T. G. Conley, J. Econometrics 92(1), 1999.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, counted_labels

SCORE_CELL = 16  # pixels a side, in which scores are summed
NEARBY = 0.25  # of a frame's height and width, up to which cells count together
# What half a 95 % interval has more than 1.96 errors if these are of scores that far
# apart along one axis. Source: N. M. Kiefer, T. J. Vogelsang, Econometric Theory 21(6),
# 2005, table 1 (Bartlett).
WIDER = (1.9600 + 2.9694 * NEARBY + 0.4160 * NEARBY**2 - 0.5324 * NEARBY**3) / 1.9600
BY_NOISE = 0.99  # of robust errors, that are no larger where a model is right
LEAST_INVERTED = 1e-9  # of the largest eigenvalue of a correlation, that has an inverse


@dataclass(frozen=True)
class Covariances:
    """Those (n, n) of a model's smooth values: by noise, and by scores where they lie.

    places : in how many, each by itself, noise has as much chance."""

    by_noise: Array
    robust: Array
    places: float

    @property
    def errors(self) -> Array:
        """Standard errors (n,)."""
        expected = np.diag(self.by_noise)
        ratio = np.diag(self.robust) / np.where(expected > 0, expected, 1)
        return np.asarray(np.sqrt(expected * self._widening(ratio)))

    def widening_of_all(self, chosen: Sequence[int]) -> float:
        """Return how much larger than by noise squares of distances are of some values
        together; 1 of values that frames tell nothing of. Source: J. N. K. Rao, A. J.
        Scott, J. Am. Stat. Assoc. 76(374), 1981."""
        told = [number for number in chosen if self.by_noise[number, number] > 0]
        if not told:
            return 1.0
        among = np.ix_(told, told)

        def ratio(above: Array, below: Array) -> Array:
            shares = inverse_of(below[among]) * above[among]
            return np.asarray(shares.sum() / len(told))

        return float(self._widening(ratio(self.robust, self.by_noise)))

    def _widening(self, ratio: Array) -> Array:
        """Return 1 where noise explains a ratio of squares, else as much as it is."""
        most = chi2.ppf(BY_NOISE, self.places) / self.places
        return np.where(ratio > most, ratio * WIDER**4, 1.0)


def covariances(base: Linearisation, score: Array, information: Array) -> Covariances:
    """Return those of the values of a model by frames that it was fitted to.

    score, information : as of `Linearisation.system`."""
    inverse = inverse_of(information)
    if not information.size:
        return Covariances(inverse, inverse, 1.0)
    spread, places = _spread(base, inverse @ score)
    return Covariances(inverse, inverse @ spread @ inverse, places)


def inverse_of(information: Array) -> Array:
    """Return the inverse of Fisher's information, 0 for what nothing tells."""
    if not information.size:
        return information
    scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
    correlation = information / np.outer(scale, scale)
    inverse = np.linalg.pinv(correlation, rcond=LEAST_INVERTED, hermitian=True)
    return np.asarray(inverse / np.outer(scale, scale))


def _spread(base: Linearisation, step: Array) -> tuple[Array, float]:
    """Return ((n, n) products of scores of cells, those that are near each other
    together; in how many places, each by itself, noise has as much chance).

    step : (n,) to where all scores together are 0."""
    sums: dict[tuple[int, int], Array] = defaultdict(lambda: np.zeros(()))
    pixels: dict[tuple[int, int], Array] = defaultdict(lambda: np.zeros(()))
    frames = base.likelihood.frames
    for frame, scores in zip(frames, base.score_sums(_cells, step), strict=True):
        counted, number = counted_labels(frame, _cells)
        shape = _grid(frame)
        sums[shape] = sums[shape] + scores
        pixels[shape] = pixels[shape] + np.bincount(counted, minlength=number)
    spread, chance, total = np.zeros((step.size, step.size)), 0.0, 0.0
    for shape, scores in sums.items():
        spread += scores @ _with_neighbours(scores, shape).T
        whole = pixels[shape]
        chance += float(whole @ _with_neighbours(whole[None], shape, 2)[0])
        total += float(whole.sum())
    return spread, total**2 / max(chance, 1.0)


def _grid(frame: Frame) -> tuple[int, int]:
    """Return the rows and columns of a frame's cells; no columns of patches of a chart,
    which lie nowhere and are a cell each."""
    if frame.samples is not None:
        return len(frame.signal), 0
    height, width = frame.tiles.shape
    return -(-height // SCORE_CELL), -(-width // SCORE_CELL)


def _cells(frame: Frame) -> tuple[NDArray[np.intp], int]:
    """Return (the cell of each pixel of a frame, how many there are)."""
    height, width = _grid(frame)
    if not width:
        return np.arange(height)[:, None, None], height
    rows, columns = frame.tiles.rows_and_columns()
    return rows // SCORE_CELL * width + columns // SCORE_CELL, height * width


def _with_neighbours(sums: Array, shape: tuple[int, int], power: int = 1) -> Array:
    """Return (n, cells) of sums (n, cells) with those nearby, by a power of weights
    that fall along rows and columns as a triangle: products with such sums are no less
    than 0. Source: W. K. Newey, K. D. West, Econometrica 55(3), 1987."""
    if not shape[1]:
        return sums
    fields = sums.reshape(-1, *shape)
    for axis, count in ((1, shape[0]), (2, shape[1])):
        places = np.arange(count)
        away = np.abs(places[:, None] - places) / max(NEARBY * count, 1.0)
        weights = np.maximum(1 - away, 0) ** power
        fields = np.moveaxis(np.tensordot(fields, weights, (axis, 0)), -1, axis)
    return np.asarray(fields.reshape(sums.shape))
