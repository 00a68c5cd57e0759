# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rectangles on the ground, so that nothing stands in another. Metres, radians."""

import math
from dataclasses import dataclass

# Width along x and length along y before the turn, in metres.
FOOTPRINTS = {
    "hatchback": (1.85, 4.3),
    "saloon": (1.85, 4.8),
    "van": (2.0, 5.0),
    "bus": (2.6, 11.8),
    "bicycle": (0.6, 1.8),
    "person": (0.6, 0.6),
    "umbrella": (1.2, 1.2),
    "pole": (0.3, 0.3),
}


@dataclass(frozen=True)
class Rectangle:
    """A rectangle around (x, y), width along x and length along y before its turn."""

    x: float
    y: float
    width: float
    length: float
    turn: float = 0.0

    def corners(self):
        """Return its four corners."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        w, h = self.width / 2, self.length / 2
        around = ((-w, -h), (w, -h), (w, h), (-w, h))
        return [(self.x + c * a - s * b, self.y + s * a + c * b) for a, b in around]

    def axes(self):
        """Return the directions of its sides."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        return (c, s), (-s, c)


def of(name, x, y, turn=0.0):
    """Return the rectangle of what has a name in FOOTPRINTS."""
    return Rectangle(x, y, *FOOTPRINTS[name], turn)


def overlap(first, second, gap=0.0):
    """Return whether two rectangles come nearer than @gap metres along some axis.

    Method: separating axes; two convex shapes are apart if their shadows on some
    side's direction are."""
    for axis in (*first.axes(), *second.axes()):
        a = [axis[0] * x + axis[1] * y for x, y in first.corners()]
        b = [axis[0] * x + axis[1] * y for x, y in second.corners()]
        if max(a) + gap <= min(b) or max(b) + gap <= min(a):
            return False
    return True


class Floor:
    """The ground of one scene: what has been put down keeps its place."""

    def __init__(self):
        self.taken = []

    def is_free(self, rectangle, gap=0.1):
        """Return whether nothing is nearer than @gap metres."""
        return not any(overlap(rectangle, other, gap) for other in self.taken)

    def take(self, rectangle, gap=0.1):
        """Put @rectangle down and return True, or False where something stands."""
        free = self.is_free(rectangle, gap)
        if free:
            self.taken.append(rectangle)
        return free

    def keep_clear(self, camera, ahead=4.0, wide=1.6):
        """Reserve the ground before and under a camera, along its view."""
        (x, y, _), target = camera.place, camera.target
        turn = math.atan2(-(target[0] - x), target[1] - y)
        middle = ahead / 2 - 0.5
        x, y = x - math.sin(turn) * middle, y + math.cos(turn) * middle
        self.taken.append(Rectangle(x, y, wide, ahead + 1.0, turn))
