# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The smallest set of names that explains: of names that can stand for each other."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

Names = Sequence[str]


class Way(NamedTuple):
    """train : fits names to some frames. value : log-likelihood of others, of names
    that are so fitted. refitted : the same, of names that are fitted to them."""

    train: Callable[[Names], Any]
    value: Callable[[Names, Any], float]
    refitted: Callable[[Names], float]


class SmallestSet(NamedTuple):
    """gains : nats of each name of the set. alike : other names that may be in the
    place of one: the set is worth less with them, but by less than half of what a name
    needs."""

    gains: dict[str, float]
    alike: Mapping[str, Collection[str]]


def smallest_set(
    every: Mapping[str, int], least: float, ways: Sequence[Way]
) -> SmallestSet:
    """Return the set that is worth most on frames that did not fit it: its
    log-likelihood, less @least for each name, and less 1 for each parameter that is as
    it was trained, however well that is known (H. Akaike, IEEE Trans. Automatic Control
    19(6), 1974); the mean of both ways of two splits. Gains are over the same set
    without the name, fitted anew: of two ways, the mean of likelihood ratios.

    every : names and how many such parameters each has."""
    values = {
        names: [way.value(names, way.train(names)) for way in ways]
        for size in range(len(every) + 1)
        for names in combinations(every, size)
    }

    def worth(names: tuple[str, ...]) -> float:
        cost = sum(least + every[name] for name in names)
        return float(np.mean(values[names])) - cost

    best = max(values, key=worth)
    gains, alike = {}, {}
    for name in best:
        rest = [other for other in best if other != name]
        each = [
            value - way.refitted(rest)
            for value, way in zip(values[best], ways, strict=True)
        ]
        gains[name] = float(np.logaddexp.reduce(each)) - math.log(len(ways))
        alike[name] = [
            other
            for other in every
            if other not in best
            and worth(_in_order(every, {*rest, other})) > worth(best) - least / 2
        ]
    return SmallestSet(gains, alike)


def _in_order(every: Mapping[str, int], names: Collection[str]) -> tuple[str, ...]:
    return tuple(name for name in every if name in names)
