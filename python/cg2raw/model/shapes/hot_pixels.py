# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hot pixels: few, far above the others, in proportion to time, in both splits."""

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.dark_law import DarkLaw, fitted, median_of, nats_of, with_hot
from cg2raw.model.figures import Figure
from cg2raw.model.recorded import FINE
from cg2raw.model.shapes.base import Shape, Shown, nats_of_overlap, points_of
from cg2raw.model.shapes.random_telegraph_noise import noisy_outliers
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.dark_rates import slope_of

NAME = "hot_pixels"
FAR = 8.0  # times the noise of a rate, of pixels that both splits must show


def hot_pixels(shown: Shown) -> Shape | None:
    """Return their evidence: that of their law beside any of the others, with those
    that a profile states, or of how many are the same in both splits, whichever is
    less. None without two exposure times."""
    rates = {one.split: one for one in shown.statistics.rates}
    if not set(shown.splits) <= rates.keys():
        return None
    training, validation = (rates[split] for split in shown.splits)
    counts = validation.counts.astype(float)
    first, second = (shown.shot(rates[split]) for split in shown.splits)
    law = fitted(training.counts.astype(float), first, uneven=True, hot=True)
    if shown.hot is None:
        without = fitted(counts, second, uneven=True, hot=False)
    else:
        fraction, rate = shown.hot
        without = with_hot(counts, second, fraction, rate / validation.noise)
    trained = law.over(validation.noise / training.noise, second)
    of_law = nats_of(counts, trained) - without.nats
    nats = min(of_law, nats_of_overlap(_far(shown), shown.samples))
    return Shape(NAME, nats, _figures(law, training.noise))


def dark_median(
    shown: Shown, split: str, is_normal: bool
) -> tuple[float, float] | None:
    """Return by how much the dark current of most pixels, their median, is above the
    mean of those that are not masked, and its standard error, DN/s; None without two
    exposure times. Where noise is not normal, as where codes are few, the error is as
    large. is_normal : it has no tails."""
    darks = shown.statistics.shortest_darks(split)
    each = [plane.power[darks].min(initial=np.inf) for plane in shown.statistics.planes]
    is_normal &= min(each) > FINE + ROUNDING
    for one in shown.statistics.rates:
        if one.split == split:
            value, error = median_of(one.counts.astype(float), shown.shot(one))
            return value * one.noise, (error if is_normal else abs(value)) * one.noise
    return None


def _far(shown: Shown) -> list[NDArray[np.bool_]]:
    """Return, for each split, which masked points gather charge and do not jump."""
    points = points_of(shown.statistics)
    rates, noises = [], []
    for split in shown.splits:
        slope = slope_of(shown.statistics, split)
        assert slope is not None
        of_planes = zip(shown.statistics.planes, points, slope.noise, strict=True)
        each = [
            (slope.weights @ plane.outliers[:, used], np.full(used.sum(), noise))
            for plane, used, noise in of_planes
        ]
        rate, noise = np.concatenate(each, axis=1)
        rates.append(rate)
        noises.append(noise)
    statistics = shown.statistics
    darks = ~statistics.is_flat & (statistics.pairs > 0)
    darks &= np.isin(statistics.splits, shown.splits)
    jumps = noisy_outliers(shown, np.flatnonzero(darks)).any(axis=0)
    return [
        (rate > FAR * noise) & ~jumps for rate, noise in zip(rates, noises, strict=True)
    ]


def _figures(law: DarkLaw, noise: float) -> tuple[Figure, ...]:
    share, rate = law.errors[3], law.errors[4] * noise
    return (
        Figure.normal("fraction", "1", law.fraction, share, 0.0),
        Figure.normal("rate", "DN/s", law.hot_rate * noise, rate, 0.0),
    )
