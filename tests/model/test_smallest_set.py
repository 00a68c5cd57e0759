# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Of names that can stand for each other, those that need fewest."""

import numpy as np
import pytest

from cg2raw.model.smallest_set import smallest_set

# a, b and their sum, ab: alone it is as good as both.
PATTERNS = {"a": [1, 0, 0], "b": [0, 1, 0], "ab": [1, 1, 0], "c": [0, 0, 1]}


def found(truth, least=8.0, error=0.1):
    def fitted(names):
        design = np.array([PATTERNS[name] for name in names]).reshape(len(names), 3)
        return np.linalg.pinv(design.T) @ truth

    def value(names, values):
        design = np.array([PATTERNS[name] for name in names]).reshape(len(names), 3)
        rest = truth - values @ design
        return -float(rest @ rest) / 2 / error**2

    return smallest_set(
        dict.fromkeys(PATTERNS, 1),
        least,
        train=fitted,
        value=value,
        refitted=lambda names: value(names, fitted(names)),
    )


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
    [(0.0, []), (0.7, ["ab"]), (1.0, ["a"]), (2.0, [])],
)
def test_names_that_explain_nearly_as_well_are_alike(second, alike):
    """2 of a and some of b: 1 is as well half of it and both alike."""
    [[name, others]] = found(np.array([2.0, second, 0.0]), error=0.3).alike.items()
    assert (name, others) == ("ab" if second > 0.9 else "a", alike)
