# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Selection on planted matrices."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.scenes.gram import Gram, Space
from cg2raw.diagnose.scenes.selection import (
    Selection,
    _log_chance,
    limits,
    nats_to_be_seen,
)

LEAST = math.log(4 / 0.01)
SPACE = Space.of({"one": 1, "two": 1, "both": 1, "other": 1})


def pair(theta, seed=1, n=2000, alike=()):
    """Return (train, validation) of columns of unit variance at a truth.

    alike : (place, [places]) of a column that is the sum of others."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(2):
        columns = rng.normal(size=(4, n))
        for place, others in alike:
            columns[place] = columns[list(others)].sum(0)
        z = np.asarray(theta) @ columns + rng.normal(size=n)
        found.append(Gram(n, z @ z, columns @ z, columns @ columns.T))
    return found


def chosen(grams, most=9, known=()):
    return Selection(SPACE, *grams, LEAST, 0.01, known).run(SPACE.slices, most)


def test_what_is_planted_is_named_and_nothing_else():
    found = chosen(pair([0.5, 0, 0, -0.3]))
    assert found.names == ["one", "other"]
    assert chosen(pair([0.3, 0, 0, -0.5])).names == ["other", "one"]  # best first
    # A strength s gains s^2 n / 2 on average.
    assert found.nats["one"] == pytest.approx(0.25 * 1000, rel=0.3)


def test_nothing_is_named_of_noise():
    for seed in range(40):
        assert chosen(pair([0, 0, 0, 0], seed)).names == []


def test_one_name_stands_for_two_that_do_as_well():
    """From all effects down, two of them would have stayed."""
    found = chosen(pair([0.3, 0.3, 0, 0], alike=[(2, (0, 1))]))
    assert found.names == ["both"]
    assert found.alike["both"] == [("one", "two")]


def test_names_that_look_alike_are_said():
    found = chosen(pair([0.4, 0, 0, 0], alike=[(1, (0,))]))
    assert len(found.names) == 1
    assert [*found.alike.values()][0] in ([("one",)], [("two",)])


@pytest.mark.parametrize(("more", "alike"), [(1, []), (3, [("narrow",)])])
def test_an_effect_of_fewer_parameters_is_alike_within_a_nat_of_each(more, alike):
    """What the wide one has besides gains 6 nats, of which 4.6 would be sure."""
    space = Space.of({"wide": 1 + more, "narrow": 1})
    rows = np.eye(1 + more)[[*range(1 + more), 0]]  # the narrow one is its first
    z = np.sqrt(2 * np.array([100.0, 6.0, *np.zeros(more - 1)]))
    gram = Gram(50, z @ z / 2, rows @ z / 2, rows @ rows.T / 2)
    found = Selection(space, gram, gram, LEAST, 0.01).run(space.slices, 9)
    assert found.names == ["wide"]
    assert found.alike["wide"] == alike


def test_the_most_names():
    assert chosen(pair([0.5, 0, 0, -0.3]), most=1).names == ["one"]
    assert chosen(pair([0.5, 0, 0, -0.3]), most=0).names == []


def test_what_is_known_is_fitted_beside_all_and_not_named():
    grams = pair([0.5, 0, 0, 0.2])
    selection = Selection(SPACE, *grams, LEAST, 0.01, ["one"])
    assert selection.run(["two", "both", "other"], 9).names == ["other"]


def test_what_fixed_patterns_leave_in_all_frames_is_no_name():
    """They are as large in training and in validation, and no noise of one frame."""
    pattern = 0.2  # of an effect, standard deviation
    false, strong = 0, []
    for seed in range(40):
        part = np.random.default_rng(seed).normal(0, pattern, 4)
        theta, shared = part + [0, 2, 0, 0], np.diag(np.full(4, (2000 * pattern) ** 2))
        grams = [replace(one, shared=shared) for one in pair(theta, seed)]
        plain = [replace(one, shared=0.0) for one in grams]
        false += any(name != "two" for name in chosen(plain).names)
        strong.append(chosen(grams).names)
        huge = [replace(one, shared=shared) for one in pair([0, 1e3, 0, 0], seed)]
        assert 1e6 < chosen(huge).nats["two"] < np.inf
    assert false > 30
    assert strong.count(["two"]) >= 38


def test_a_limit_is_the_strength_that_95_of_100_sets_show():
    _, validation = pair([0, 0, 0, 0])
    strength = limits(SPACE, validation, [], ["one"], LEAST)["one"][0]

    def hits(share):
        theta = [share * strength, 0, 0, 0]
        return np.mean(["one" in chosen(pair(theta, n)).names for n in range(300)])

    assert 0.91 < hits(1) < 0.98
    assert hits(0.6) < 0.6


@pytest.mark.parametrize("count", [1, 4])
def test_what_is_to_be_seen_is_gained_in_95_of_100_sets(count):
    truth = np.zeros((count, 1))
    truth[0] = math.sqrt(2 * nats_to_be_seen(LEAST, count))
    rng = np.random.default_rng(count)
    fitted, seen = truth + rng.standard_normal((2, count, 100_000))
    gains = (fitted * seen - fitted**2 / 2).sum(axis=0)
    assert np.mean(gains > LEAST) == pytest.approx(0.95, abs=0.005)


def test_a_limit_has_the_unit_of_its_parameter():
    """Columns without noise of their own: the limit is exact."""
    space = Space.of({"one": 1, "two": 2})
    gram = Gram(200, 200.0, np.zeros(3), 200 * np.eye(3))
    found = limits(space, gram, [], ["one", "two"], LEAST)
    for name, count in (("one", 1), ("two", 2)):
        strength = math.sqrt(2 * nats_to_be_seen(LEAST, count) / 200)
        assert found[name] == pytest.approx(strength)


def test_what_no_scene_shows_has_no_limit():
    _, validation = pair([0, 0, 0, 0], alike=[(1, (0,))])
    assert limits(SPACE, validation, ["one"], ["two"], LEAST)["two"] is None


@pytest.mark.parametrize("square", [-1e-12, 0.0, 3.0, 999.0, 2000.0])
def test_chi_square_of_two_is_exponential(square):
    """A square that rounding makes negative is none."""
    assert _log_chance(square, 2) == pytest.approx(-max(square, 0.0) / 2)
