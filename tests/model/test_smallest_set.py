# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Of names that can stand for each other, those that need fewest."""

import numpy as np
import pytest

from cg2raw.model.smallest_set import Way, smallest_set

# a, b and their sum, ab: alone it is as good as both.
PATTERNS = {"a": [1, 0, 0], "b": [0, 1, 0], "ab": [1, 1, 0], "c": [0, 0, 1]}


def found(*truths, least=8.0, error=0.1):
    """Of a truth, fitted to itself; of two, each fitted to the other."""

    def fitted(names, truth):
        design = np.array([PATTERNS[name] for name in names]).reshape(len(names), 3)
        return np.linalg.pinv(design.T) @ truth

    def value(names, values, truth):
        design = np.array([PATTERNS[name] for name in names]).reshape(len(names), 3)
        rest = truth - values @ design
        return -float(rest @ rest) / 2 / error**2

    ways = [
        Way(
            lambda names, of=of: fitted(names, of),
            lambda names, values, by=by: value(names, values, by),
            lambda names, by=by: value(names, fitted(names, by), by),
        )
        for of, by in zip(truths, truths[::-1], strict=True)
    ]
    return smallest_set(dict.fromkeys(PATTERNS, 1), least, ways)


@pytest.mark.parametrize(
    ("truth", "names"),
    [
        ([0, 0, 0], set()),
        ([2, 0, 0], {"a"}),
        ([0, 2, 0], {"b"}),
        ([2, 2, 0], {"ab"}),
        ([2, 2, 2], {"ab", "c"}),
        ([0, 0, 0.3], set()),  # 4.5 nats, which are not enough
    ],
)
def test_the_set_is_the_smallest(truth, names):
    assert set(found(np.array(truth, float)).gains) == names


def test_a_gain_is_over_the_others_fitted_anew():
    """2 of a, error 0.1: 200 nats over nothing."""
    assert found(np.array([2.0, 0.0, 0.0])).gains["a"] == pytest.approx(200)


@pytest.mark.parametrize(
    ("second", "alike"),
    [(0.0, []), (0.8, ["ab"]), (1.0, ["a"]), (2.0, [])],
)
def test_names_that_explain_nearly_as_well_are_alike(second, alike):
    """2 of a and some of b: 1 is as well half of it and both alike."""
    [[name, others]] = found(np.array([2.0, second, 0.0]), error=0.3).alike.items()
    assert (name, others) == ("ab" if second > 0.9 else "a", alike)


def test_of_two_ways_the_mean_counts():
    """One split alone would have it that a is all."""
    first, second = np.array([2.0, 1.6, 0.0]), np.array([2.0, 0.6, 0.0])
    assert set(found(second, error=0.3).gains) == {"a"}
    assert set(found(first, second, error=0.3).gains) == {"ab"}
