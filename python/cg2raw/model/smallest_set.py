# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The smallest set of names that explains: of names that can stand for each other."""

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import TypeVar

Trained = TypeVar("Trained")
Names = Sequence[str]


def gains_in_smallest_set(
    every: Mapping[str, int],
    least: float,
    *,
    train: Callable[[Names], Trained],
    value: Callable[[Names, Trained], float],
    refitted: Callable[[Names], float],
) -> dict[str, float]:
    """Return the nats of each name of the set that is worth most on validation frames:
    its log-likelihood, as trained, less @least for each name, and less 1 for each
    parameter that is as it was trained, however well that is known (H. Akaike, IEEE
    Trans. Automatic Control 19(6), 1974). They are over those of the same set without
    the name, fitted anew.

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
    return {
        name: values[best] - refitted([other for other in best if other != name])
        for name in best
    }
