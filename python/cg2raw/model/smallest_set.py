# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The smallest set of names that explains: of names that can stand for each other."""

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple, TypeVar

Trained = TypeVar("Trained")
Names = Sequence[str]


class SmallestSet(NamedTuple):
    """gains : nats of each name of the set. alike : other names that may be in the
    place of one: with them the set is worth less by no more than a name needs."""

    gains: dict[str, float]
    alike: Mapping[str, Collection[str]]


def smallest_set(
    every: Mapping[str, int],
    least: float,
    *,
    train: Callable[[Names], Trained],
    value: Callable[[Names, Trained], float],
    refitted: Callable[[Names], float],
) -> SmallestSet:
    """Return the set that is worth most on validation frames: its log-likelihood, as
    trained, less @least for each name, and less 1 for each parameter that is as it was
    trained, however well that is known (H. Akaike, IEEE Trans. Automatic Control 19(6),
    1974). Gains are over the same set without the name, fitted anew.

    every : names and how many such parameters each has.
    train : fits names to training frames. value : log-likelihood of validation frames.
    refitted : the same, of names that are fitted to them."""
    values: dict[tuple[str, ...], float] = {}
    for size in range(len(every) + 1):
        for names in combinations(every, size):
            values[names] = value(names, train(names))

    def worth(names: tuple[str, ...]) -> float:
        return values[names] - sum(least + every[name] for name in names)

    best = max(values, key=worth)
    gains, alike = {}, {}
    for name in best:
        rest = [other for other in best if other != name]
        gains[name] = values[best] - refitted(rest)
        alike[name] = [
            other
            for other in every
            if other not in best
            and worth(_in_order(every, {*rest, other})) > worth(best) - least
        ]
    return SmallestSet(gains, alike)


def _in_order(every: Mapping[str, int], names: Collection[str]) -> tuple[str, ...]:
    return tuple(name for name in every if name in names)
