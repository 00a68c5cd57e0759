# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rectangles on the ground: overlap by published geometry, with planted cases."""

import math

import pytest

from studies.night_scenes.choices import floor
from studies.night_scenes.choices.floor import Floor, Rectangle, overlap


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (Rectangle(0, 0, 2, 4), Rectangle(1.9, 0, 2, 4), True),
        (Rectangle(0, 0, 2, 4), Rectangle(2.1, 0, 2, 4), False),
        (Rectangle(0, 0, 2, 4), Rectangle(0, 3.9, 2, 4, math.pi), True),
        (Rectangle(0, 0, 2, 4), Rectangle(2.9, 0, 2, 4, math.pi / 2), True),
        (Rectangle(0, 0, 2, 4), Rectangle(3.1, 0, 2, 4, math.pi / 2), False),
        # Their bounding boxes meet, they do not: a corner passes by a corner.
        (Rectangle(0, 0, 2, 2, math.pi / 4), Rectangle(1.9, 1.9, 2, 2), False),
        (Rectangle(0, 0, 2, 2, math.pi / 4), Rectangle(1.6, 1.6, 2, 2), True),
        (Rectangle(0, 0, 9, 9), Rectangle(0, 0, 1, 1, 0.3), True),  # one in the other
    ],
)
def test_overlap(first, second, expected):
    assert overlap(first, second) is expected
    assert overlap(second, first) is expected


def test_a_gap_counts():
    first, second = Rectangle(0, 0, 2, 2), Rectangle(2.3, 0, 2, 2)
    assert not overlap(first, second, 0.2)
    assert overlap(first, second, 0.4)


def test_what_is_taken_is_not_given_twice():
    ground = Floor()
    assert ground.take(floor.of("hatchback", 0, 0))
    assert not ground.take(floor.of("hatchback", 0.5, 3.0))
    assert ground.take(floor.of("hatchback", 0.0, 5.0))
    assert len(ground.taken) == 2


def test_nothing_stands_before_the_camera():
    class View:
        place, target = (3.0, -2.0, 1.6), (3.0, 30.0, 2.0)

    ground = Floor()
    ground.keep_clear(View)
    assert not ground.is_free(floor.of("person", 3.0, 0.5))
    assert ground.is_free(floor.of("person", 3.0, 4.0))
    assert ground.is_free(floor.of("person", 5.5, 0.0))
