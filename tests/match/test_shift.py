# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The distribution of shifts between two sets of levels, whose truth is known."""

import numpy as np
import pytest
from scipy.stats import kurtosis, t

from cg2raw.match import Levels, shift_between, shift_of
from cg2raw.match.comparison import stops_words, times_words
from cg2raw.match.shift import (
    LEVEL,
    MOST_SHIFT,
    any_shape,
    chances,
    intervals,
    normal,
    shape_of,
    shrunk,
    variance,
)
from tiers import first_fast

NONE = np.empty(0)


def fitted(renders, captures):
    """Return (median, spread), and which shape was taken."""
    shape = shape_of(renders, captures, 0)
    found = shape(renders, captures)
    return found.median, found.spread, shape


def known(levels):
    return Levels(levels, NONE, NONE)


def two_kinds(rng, count):
    """Return levels of which half are of night scenes."""
    day, night = rng.normal(-3, 0.4, count), rng.normal(-7, 0.8, count)
    return np.where(rng.random(count) < 0.5, day, night)


def skewed(rng, count):
    return -2 - rng.gamma(2, 1, count)


@pytest.mark.parametrize("scenes", [two_kinds, skewed])
def test_the_shape_of_the_scenes_does_not_matter(scenes):
    """The difference of medians is off by 1.2 stops where there are two kinds."""
    rng = np.random.default_rng(1)
    found = [
        shape(scenes(rng, 2000), known(scenes(rng, 2000) + rng.normal(1.5, 0.7, 2000)))
        for shape in 3 * [any_shape, normal]
    ]
    found = [(one.median, one.spread) for one in found]
    assert np.mean(found, axis=0) == pytest.approx([1.5, 0.7], abs=0.06)


def test_a_kernel_adds_no_variance():
    levels = np.random.default_rng(3).gamma(2, 1.5, 40)
    scenes, width = shrunk(levels)
    assert 0 < width < levels.std()
    assert scenes.var() + width**2 == pytest.approx(levels.var())
    assert scenes.mean() == pytest.approx(levels.mean())


def test_other_scenes_are_no_spread():
    """Of levels of another shape, a meter's, the shift is that of the middles."""
    rng = np.random.default_rng(9)
    renders, captures = rng.normal(-6, 1.2, 200), -3.2 - rng.gamma(1.2, 1.3, 200)
    median, spread, shape = fitted(renders, known(captures))
    assert shape is any_shape
    assert median == pytest.approx(np.median(captures) - np.median(renders), abs=0.2)
    assert spread < 1


def test_an_exposure_is_normal_unless_captures_tell_otherwise():
    """Then the median's error is two thirds of that of any shape; 1 test of 100 is
    wrong by chance, of 20 hardly more than one."""
    rng = np.random.default_rng(10)
    shapes, errors = [], []
    for _ in range(20):
        scenes = rng.normal(-4, 0.3, (2, 200))
        exposures = rng.normal(1.5, 0.7, 200)
        median, spread, shape = fitted(scenes[0], known(scenes[1] + exposures))
        shapes.append(shape)
        errors.append((median - np.median(exposures), spread - exposures.std()))
    assert shapes.count(normal) >= 19
    median, spread = np.sqrt(np.mean(np.square(errors), axis=0))
    assert median < 0.065 and spread < 0.045


def test_exposures_of_two_kinds_are_no_normal_one():
    """Of half of the captures 0, of half 4: the middle of a normal one has none."""
    rng = np.random.default_rng(11)
    scenes = rng.normal(-6, 0.3, (2, 200))
    captures = known(scenes[1] + 4.0 * (np.arange(200) % 2))
    assert shape_of(scenes[0], captures, 0) is any_shape
    stops = any_shape(scenes[0], captures).stops(np.linspace(0, 1, 201))
    assert np.mean(np.abs(stops - 2) < 1) < 0.1


def test_bounds_count_as_such():
    """Of captures above -1 and below -6 stops nothing else is known."""
    rng = np.random.default_rng(2)
    scenes = rng.normal(-4, 0.6, (2, 5000))
    levels = scenes[1] + rng.normal(1.5, 1.5, 5000)
    white, black = levels > -1, levels < -4
    captures = Levels(
        levels[~white & ~black], np.full(white.sum(), -1.0), np.full(black.sum(), -4.0)
    )
    assert white.sum() + black.sum() > 1500
    assert fitted(scenes[0], captures)[:2] == pytest.approx([1.5, 1.5], abs=0.1)


def test_half_of_even_scenes_lie_below_a_bound_in_their_middle():
    """And half above, if nothing is shifted; 1 % of frames tell nothing."""
    middle = np.array([-4.0])
    found, _ = chances(np.linspace(-5, -3, 9), Levels(NONE, middle, middle))
    assert found[:, MOST_SHIFT] == pytest.approx(0.99 / 2, abs=1e-4)


def test_a_few_frames_that_tell_nothing_do_not_matter():
    rng = np.random.default_rng(3)
    levels = rng.normal(-4, 0.5, 400) + rng.normal(1, 0.4, 400)
    levels[:4] = -15
    median, spread, _ = fitted(rng.normal(-4, 0.5, 400), known(levels))
    assert median == pytest.approx(1, abs=0.1)
    assert spread == pytest.approx(0.4, abs=0.15)


def test_of_pairs_the_quantiles_are_those_of_what_was_found():
    values = np.random.default_rng(4).uniform(0, 2, 300)
    found = shift_of(known(values))
    assert found.median == np.median(values)
    assert found.spread == pytest.approx(values.std(), abs=0.03)
    probabilities, stops = np.transpose(found.quantiles)
    assert (probabilities[0], probabilities[-1]) == (0, 1)
    assert np.all(np.diff(probabilities) > 0) and np.all(np.diff(stops) >= 0)
    assert (stops[0], stops[-1]) == (values.min(), values.max())


def test_the_quantiles_of_a_drawn_exposure_have_its_median_and_spread():
    rng = np.random.default_rng(5)
    captures = known(rng.normal(-3, 1.2, 200))
    found = shift_between(rng.normal(-5, 0.5, 200), captures)
    drawn = np.interp(rng.random(100_000), *np.transpose(found.quantiles))
    assert np.median(drawn) == pytest.approx(found.median, abs=0.02)
    assert drawn.std() == pytest.approx(found.spread, rel=0.03)


@pytest.mark.parametrize("count", first_fast([10, 20], 1))
def test_few_frames_have_intervals_that_hold_the_truth(count, monkeypatch):
    monkeypatch.setattr("cg2raw.match.shift.DRAWS", 60)
    rng = np.random.default_rng(6)
    for seed in range(6):
        renders, scenes = rng.normal(-4, 1, (2, count))
        captures = known(scenes + rng.normal(1.5, 0.7, count))
        found = shift_between(renders, captures, seed)
        assert found.median_range[0] < 1.5 < found.median_range[1]
        assert found.spread_range[0] <= 0.7 < found.spread_range[1]


def test_intervals_are_no_narrower_than_those_of_normal_levels():
    """By Welch's degrees of freedom, of three levels each, of which the bootstrap is
    one value here."""
    found = 4.0, 1.0
    renders, captures = np.array([0.0, 1.0, 2.0]), known(np.array([3.0, 5.0, 7.0]))
    shares = np.array([1.0, 4.0]) / 3
    freedom = shares.sum() ** 2 / (shares**2 / 2).sum()
    half = t.ppf((1 + LEVEL) / 2, freedom) * np.sqrt(shares.sum())
    of_median, (least, most) = intervals(found, renders, captures, 1, lambda *_: found)
    assert of_median == pytest.approx((4 - half, 4 + half))
    assert least == 0 and most > 10


def test_it_is_the_same_each_time():
    rng = np.random.default_rng(7)
    renders, captures = rng.normal(-5, 1, 30), known(rng.normal(-4, 1, 30))
    assert shift_between(renders, captures) == shift_between(renders, captures)


@pytest.mark.parametrize(
    ("ratio", "words"),
    [
        (0.5, "half"),
        (2.1, "twice"),
        (1.04, "just"),
        (1.5, "1.5 times"),
        (0.7, "0.7 times"),
    ],
)
def test_how_a_ratio_is_said(ratio, words):
    assert times_words(ratio) == words


@pytest.mark.parametrize(
    ("stops", "words"),
    [
        (0.04, "as bright as those of captures"),
        (-0.04, "as bright as those of captures"),
        (0.06, "0.1 stops brighter"),
        (-1.25, "1.2 stops darker"),
    ],
)
def test_how_stops_are_said(stops, words):
    assert stops_words(stops) == f"are {words}"


def test_levels_are_drawn_and_bounded_as_they_are():
    """Of a draw with replacement, each level has its share in whichever part it is; of
    other levels, as many of the lowest and highest are but bounds."""
    levels = Levels(np.arange(60.0), np.full(25, 100.0), np.full(15, -100.0))
    rng = np.random.default_rng(3)
    draws = [levels.drawn(rng) for _ in range(400)]
    assert {len(one) for one in draws} == {100}
    for name, share in (("known", 60), ("above", 25), ("below", 15)):
        parts = [getattr(one, name) for one in draws]
        assert np.mean([len(part) for part in parts]) == pytest.approx(share, abs=1)
        assert set(np.concatenate(parts)) == set(getattr(levels, name))
    found = levels.bounded(rng.permutation(200.0 + np.arange(100)))
    np.testing.assert_array_equal(found.known, 215.0 + np.arange(60))
    assert set(found.above) == {274.0} and len(found.above) == 25
    assert set(found.below) == {215.0} and len(found.below) == 15


@pytest.mark.parametrize(
    ("levels", "squares", "ends"),
    [
        (np.arange(10.0), 82.5, (1.735, 23.589)),  # even ones, whose tails are short
        ([-1.0, 0, 0, 0, 0, 1], 2.0, (0.412, 16.750)),  # of a normal law's kurtosis
    ],
)
def test_a_variance_of_few_levels_is_no_surer_than_that_of_normal_ones(
    levels, squares, ends
):
    """By the chi-square table, 1 % of n - 1 degrees of freedom lie outside."""
    square, low, high = variance(np.array(levels))
    assert square == pytest.approx(squares / (len(levels) - 1))
    assert (low, high) == pytest.approx(
        (squares / ends[1], squares / ends[0]), rel=1e-3
    )


def test_a_variance_of_levels_with_long_tails_is_less_sure():
    """The logarithm of a variance has (kurtosis - 1) / n of error, squared."""
    levels = np.random.default_rng(8).laplace(size=4000)
    _, low, high = variance(levels)
    error = np.sqrt((kurtosis(levels, fisher=False) - 1) / len(levels))
    assert np.log(high / low) == pytest.approx(2 * 2.5758 * error, rel=0.01)
