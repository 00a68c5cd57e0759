# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scenes are known again by the ranks of luminance in a thumbnail."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import spearmanr

from cg2raw.match.scenes import ROWS, chance, correlation, nearest, pairs, ranks


def frame(thumbnail, level=0.0):
    """Return what is looked at of a frame."""
    return SimpleNamespace(thumbnail=thumbnail, level=level)


def thumbnails(count, seed=1):
    return np.random.default_rng(seed).random((count, 16, 16))


def test_the_nearest_of_many_is_the_most_correlated_other_one():
    """Frames are compared some at a time: their number does not matter."""
    found = ranks([frame(one) for one in thumbnails(2 * ROWS + 3)])
    alike = np.corrcoef(found)
    assert (nearest(found, found) == np.arange(len(found))).all()
    np.fill_diagonal(alike, -2)
    np.testing.assert_array_equal(nearest(found, found, False), alike.argmax(axis=1))


def test_frames_are_as_alike_as_spearman_has_it_of_cells_that_both_know():
    one, other = thumbnails(2)
    other = other + one
    one[:4], other[2:6] = np.nan, np.nan
    expected = spearmanr(one[6:].ravel(), other[6:].ravel()).statistic
    assert correlation(frame(one), frame(other)) == pytest.approx(expected)
    assert correlation(frame(one), frame(np.exp(9 * one))) == pytest.approx(1)
    for row, found in ((8, 1.0), (7, -1.0)):  # 64 cells, or 48, are left
        one[row:] = np.nan
        assert correlation(frame(one), frame(one)) == pytest.approx(found)
    assert correlation(frame(np.ones((16, 16))), frame(other)) == -1


def test_pairs_are_of_one_scene_whatever_the_exposure_and_the_tone():
    some = thumbnails(9)
    order = [3, 0, 5, 8]
    captures = [frame(4 * some[n] ** 2.2) for n in order] + [frame(thumbnails(1, 2)[0])]
    renders = [frame(one, level) for level, one in enumerate(some)]
    captures[0].thumbnail[:2] = np.nan  # white there
    assert pairs(captures, renders) == list(enumerate(order))
    assert pairs(captures[3:] + captures[4:], renders) == []  # but one of three


@pytest.mark.parametrize(("level", "share"), [(0.05, 0.0), (0.5, 0.5)])
def test_renders_of_another_level_that_look_alike_do_so_by_chance(level, share):
    some = thumbnails(4)
    renders = [*map(frame, some), frame(some[0], level), frame(some[1], level)]
    renders += [frame(one) for one in thumbnails(2, 3)]
    assert chance(ranks(renders), renders) == share
    captures = [frame(one) for one in some]
    sure = [] if share else list(enumerate(range(4)))
    assert pairs(captures, renders) == sure  # else they are of no scene for sure
