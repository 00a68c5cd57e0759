# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Splits: sets take turns, and a frame that is alone is divided by its pixels."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.splits import (
    GROUPS,
    groups_of_sets,
    third,
    third_of_columns,
)


def test_a_third_is_a_third_of_every_row_and_column():
    for group in GROUPS:
        mask = third((240, 480), group)
        for axis in (0, 1):
            np.testing.assert_allclose(mask.mean(axis=axis), 1 / 3)


@pytest.mark.parametrize(("width", "side"), [(201, 1), (200, 2), (200, 6), (18, 6)])
def test_columns_of_groups_are_as_many_and_each_of_one(width, side):
    each = [third_of_columns(width, g, side) for g in GROUPS]
    assert len({len(own) for own in each}) == 1
    every = np.concatenate(each)
    assert len(set(every)) == len(every) > width - 6 * side
    assert set(every) <= set(range(width))
    for own in each:
        np.testing.assert_array_equal(own % side, np.arange(len(own)) % side)
        assert (np.diff(own) > 0).all()


def test_columns_of_a_narrow_frame_are_refused():
    with pytest.raises(ValueError, match="7 px wide.*must be 8 at least"):
        third_of_columns(7, "fit", 2)
    assert third_of_columns(8, "report", 2).tolist() == [4, 7]


@pytest.mark.parametrize(
    ("strata", "declared", "expected"),
    [
        ({"a": 2, "b": 1, "c": 0}, {}, "report select fit"),
        ({"a": 0, "b": 0}, {"a": "report"}, "report -"),
    ],
)
def test_sets_take_turns(strata, declared, expected):
    """More of it: tests/diagnose/captures/test_reader.py."""
    found = groups_of_sets(strata, declared)
    assert " ".join(found[name] or "-" for name in strata) == expected
