# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random telegraph noise: the same pixels are noisy in both splits, without charge.

Tails that fall on any pixel fall on the same ones by chance; how often is known."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, erfc, log_ndtr, ndtr

from cg2raw.model.figures import Figure
from cg2raw.model.recorded import FEW_CODES, differences
from cg2raw.model.shapes.base import Shape, Shown, nats_beyond, points_of
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import BINS_PER_SIGMA, Array

NAME = "random_telegraph_noise"
NOISY = 4.0  # sigma of a pair, as the overlaps have it
CHANCE = float(erfc(NOISY / np.sqrt(2)))
# Of the squared mean of a pixel that jumps between two levels, the least variance if it
# is at the upper one in up to four of five frames: a hot pixel flickers by less.
JUMPS = 1 / 4
PLACES = 32  # within a code
LEAST_EXPECTED = 1e-9  # samples, by chance
# Of pairs of frames, in which a pixel that jumps is seen to: it has the same level in
# half of them, and not all steps are beyond NOISY.
SEEN = 0.2


@dataclass(frozen=True)
class Noisy:
    """each : (training groups, validation groups) how many samples are noisy. both :
    (training, validation) in both of two. expected : as many, by chance."""

    each: tuple[Array, Array]
    both: Array
    expected: Array


def random_telegraph_noise(shown: Shown) -> Shape | None:
    """Return the evidence of how many samples are noisy in the shortest darks of both
    splits; None without pairs, and where noise is cut at 0."""
    noisy = count_noisy(shown)
    if noisy is None or shown.is_cut:
        return None
    nats = nats_beyond(float(noisy.both.sum()), float(noisy.expected.sum()))
    seen, seen_error = _share(noisy, shown.samples)
    step, error = _mean_step(shown)
    beyond = _beyond_noise(step)
    share, share_error = seen / beyond, seen_error / beyond
    power = np.mean([p.power[_darks(shown)].mean() for p in shown.statistics.planes])
    unit = np.sqrt(2 * float(power))  # levels of a pixel differ by that more than noise
    return Shape(
        NAME,
        nats,
        (
            Figure.normal("fraction", "1", share, share_error, 0.0),
            Figure.normal("amplitude", "DN", unit * step, unit * error, 0.0),
        ),
    )


def _darks(shown: Shown) -> NDArray[np.intp]:
    each = [shown.statistics.shortest_darks(split) for split in shown.splits]
    return np.concatenate(each)


def _mean_step(shown: Shown) -> tuple[float, float]:
    """Return by how much pairs of frames differ, on average of pixels that jump, over
    their noise, and the standard error: steps are exponential, so that those beyond
    NOISY exceed it by as much as all are.

    Of a masked pixel the squares over all pairs are known: it jumps in half of them."""
    count = excess = 0.0
    for g in _darks(shown):
        pairs = int(shown.statistics.pairs[g])
        jumps = pairs / 2 / (1 - 0.5**pairs)  # of one in which it is seen
        for plane, (noisy, squares) in zip(
            shown.statistics.planes, _of_outliers(shown, np.array([g])), strict=True
        ):
            found = plane.residuals[g].astype(float)
            edges = np.arange(len(found) + 1) / BINS_PER_SIGMA
            found += found.sum() * np.diff(erfc(edges / np.sqrt(2)))  # without noise
            sizes = edges[:-1] + 0.5 / BINS_PER_SIGMA
            far = sizes > NOISY
            count += float(found[far].sum())
            excess += float(found[far] @ (sizes[far] - NOISY))
            steps = np.sqrt(np.maximum(squares[noisy] - 1, 0) * pairs / jumps)
            count += jumps * len(steps)
            excess += jumps * float((steps - NOISY).sum())
    count, mean = max(count, 1.0), max(excess, 0.0) / max(count, 1.0)
    return mean, mean / np.sqrt(count)


def _beyond_noise(step: float) -> float:
    """Return the share of exponential steps of a mean that are beyond NOISY once normal
    noise of 1 is added."""
    if step <= 0:
        return 1.0
    tail = np.exp(1 / (2 * step**2) - NOISY / step + log_ndtr(NOISY - 1 / step))
    return float(tail + ndtr(-NOISY))


def count_noisy(shown: Shown) -> Noisy | None:
    """Return how many samples are noisy in the shortest darks; None without pairs."""
    first, second = (shown.statistics.shortest_darks(split) for split in shown.splits)
    if not len(first) or not len(second):
        return None
    overlaps = shown.statistics.overlaps
    masked = [noisy_outliers(shown, groups) for groups in (first, second)]
    each = [
        np.diagonal(overlaps)[groups] + outliers.sum(axis=1)
        for groups, outliers in zip((first, second), masked, strict=True)
    ]
    both: Array = (
        masked[0].astype(float) @ masked[1].T + overlaps[np.ix_(first, second)]
    )
    expected = np.outer(*each) / shown.samples * clumped(shown)
    return Noisy((each[0], each[1]), both, np.maximum(expected, LEAST_EXPECTED))


def nats_beside_jumps(shown: Shown) -> float:
    """Return the evidence of noisy samples of validation beyond those of pixels that
    jump in both splits and those of normal noise."""
    noisy = count_noisy(shown)
    if noisy is None:
        return 0.0
    groups = shown.statistics.shortest_darks(shown.splits[1])
    beyond = np.maximum(noisy.both - noisy.expected, 0).mean(axis=0) / SEEN
    normal = CHANCE * shown.statistics.pairs[groups] * shown.samples
    return nats_beyond(float(noisy.each[1].sum()), float((beyond + normal).sum()))


def noisy_outliers(shown: Shown, groups: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return (groups, masked) whether a masked point is noisy as others are counted,
    beyond the noise of its charge, and jumps."""
    return np.concatenate([noisy for noisy, _ in _of_outliers(shown, groups)], axis=1)


def _of_outliers(
    shown: Shown, groups: NDArray[np.intp]
) -> Iterator[tuple[NDArray[np.bool_], Array]]:
    """Yield of each plane (groups, masked): what noisy_outliers returns, and the square
    of a point's noise over that of most."""
    statistics, gain = shown.statistics, shown.gain(shown.splits[0])
    most = chdtri(statistics.pairs[groups], CHANCE) / statistics.pairs[groups]
    for plane, used in zip(statistics.planes, points_of(statistics), strict=True):
        level, noise = (
            one[np.ix_(groups, np.flatnonzero(used))]
            for one in (plane.outliers, plane.outlier_noise)
        )
        usual = plane.power[groups, None] + gain * np.abs(level)
        noisy = (noise > most[:, None] * usual) & (noise > JUMPS * level**2)
        yield noisy, noise / plane.power[groups, None]


def clumped(shown: Shown) -> float:
    """Return by how much more often than by chance normal noise of few codes is beyond
    NOISY in the same pixel: it depends on where within a code a pixel is."""
    darks = shown.statistics.shortest_darks(shown.splits[0])
    power = min(float(plane.power[darks].min()) for plane in shown.statistics.planes)
    if power > FEW_CODES:
        return 1.0
    shares = differences(np.arange(PLACES) / PLACES, max(power - ROUNDING, 1e-3))
    beyond = np.floor(NOISY * np.sqrt(2 * power))
    far: Array = shares[:, np.arange(shares.shape[1]) >= max(beyond, 1.0)].sum(axis=1)
    return float((far**2).mean() / far.mean() ** 2) if far.mean() > 0 else 1.0


def _share(noisy: Noisy, samples: int) -> tuple[float, float]:
    """Return the share of samples that jump and its error: of as many as are noisy in
    the one split and as often in the other, if their chances are independent."""
    beyond = max(float((noisy.both - noisy.expected).sum()), 1.0)
    first, second = (
        max(float(each.sum()) - CHANCE * samples * len(each), 0.0)
        for each in noisy.each
    )
    found = first * second / beyond / samples
    return found, found / np.sqrt(beyond)
