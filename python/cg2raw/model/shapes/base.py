# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What shapes have in common: their evidence, and pixels that both splits show."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.figures import Figure
from cg2raw.model.fit import Fit
from cg2raw.statistics.constant import (
    ConstantStatistics,
    DarkRates,
)

CUT = 0.01  # of the samples


@dataclass(frozen=True)
class Shape:
    """An effect that some pixels have. nats : what it gains on validation frames, with
    numbers as trained. figures : its numbers by the registry's names of parameters,
    where DN are in place of shares of white. unlike : nats of what is alike, but not
    of the effect's law."""

    name: str
    nats: float
    figures: tuple[Figure, ...]
    unlike: float = 0.0


@dataclass(frozen=True)
class Shown:
    """Statistics of training and validation groups together; the names of these splits,
    and their fits. hot : share and mean rate, DN/s, of the hot pixels that a profile
    states; None without."""

    statistics: ConstantStatistics
    splits: tuple[str, str]
    fits: tuple[Fit, Fit]
    hot: tuple[float, float] | None = None

    @property
    def is_cut(self) -> bool:
        """Whether the shortest darks are cut at 0: their noise then differs with the
        offsets of pixels."""
        darks = [
            g for split in self.splits for g in self.statistics.shortest_darks(split)
        ]
        each = [plane.low[darks].max(initial=0) for plane in self.statistics.planes]
        return bool(max(each) > CUT)

    def gain(self, split: str) -> float:
        """Return DN^2 of noise for each DN of signal; 0 where it is not known."""
        fit = self.fits[self.splits.index(split)]
        each = [fit.of("gain", site)[0] for site in range(fit.parameters.sites)]
        return max(float(np.nan_to_num(np.mean(each))), 0.0)

    def shot(self, rates: DarkRates) -> float:
        """Return DarkRates.shot by the gain of the split."""
        return rates.shot(self.gain(rates.split))

    @property
    def samples(self) -> int:
        """How many there are that are in no masked line."""
        return sum(int((~p.in_lines).sum()) for p in self.statistics.planes)


def points_of(statistics: ConstantStatistics) -> list[NDArray[np.bool_]]:
    """Return (masked,) of each plane: which outliers are in no masked line."""
    return [~plane.in_lines[plane.masked] for plane in statistics.planes]


def nats_beyond(count: float, expected: float) -> float:
    """Return minus the logarithm of a bound on the chance that a Poisson number of a
    mean is as large; 0 if it is smaller. Source: H. Chernoff, Ann. Math. Stat. 23(4),
    1952."""
    if count <= expected:
        return 0.0
    if expected <= 0:
        return np.inf
    return float(count * np.log(count / expected) - count + expected)


def nats_of_overlap(sets: Sequence[NDArray[np.bool_]], samples: int) -> float:
    """Return the nats of how many samples are in both of two sets, (N,) bool."""
    first, second = sets
    expected = first.sum() * second.sum() / max(samples, 1)
    return nats_beyond(float((first & second).sum()), max(float(expected), 1e-300))
