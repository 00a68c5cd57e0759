# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shapes, and where they stand. Metres and degrees; x right, y up, z away."""

import math
from dataclasses import dataclass

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Thing:
    """A shape that reflects as a material, or shines as a light does.

    size : of a box width, height, depth; of a panel width, height; of a ball its
        radius; of a rod radius, height. A panel of turn 0 faces +z."""

    shape: str  # box, panel, ball or rod
    place: Point  # centre; of a rod its foot
    size: tuple[float, ...]
    material: int | None = None
    light: int | None = None
    level: float = 0.0  # radiance of the light; 1: that of a white under a lamp
    turn: float = 0.0  # about y

    def area(self) -> float:
        """Return what shines, in m2: the surface of the shape."""
        if self.shape == "ball":
            return 4.0 * math.pi * self.size[0] ** 2
        if self.shape == "rod":
            return 2.0 * math.pi * self.size[0] * self.size[1]
        if self.shape == "panel":
            return self.size[0] * self.size[1]
        width, height, depth = self.size
        return 2.0 * (width * height + height * depth + depth * width)


@dataclass(frozen=True)
class Spot:
    """A point on the ground and where its front faces; what stands there is built in
    coordinates of its own: across, up, forward."""

    foot: Point
    turn: float = 0.0  # 0: the front faces +z, 180: the camera

    def at(self, across: float, up: float, forward: float) -> Point:
        """Return a point of the scene."""
        c, s = math.cos(math.radians(self.turn)), math.sin(math.radians(self.turn))
        x, y, z = self.foot
        return (x + across * c + forward * s, y + up, z - across * s + forward * c)

    def box(self, centre: Point, size: Point, material: int) -> Thing:
        """Return a box that reflects."""
        return Thing("box", self.at(*centre), size, material, turn=self.turn)

    def panel(self, centre: Point, size: tuple[float, float], material: int) -> Thing:
        """Return a panel that reflects and faces forward."""
        return Thing("panel", self.at(*centre), size, material, turn=self.turn)

    def ball(self, centre: Point, radius: float, material: int) -> Thing:
        """Return a ball that reflects."""
        return Thing("ball", self.at(*centre), (radius,), material)

    def rod(self, foot: Point, radius: float, height: float, material: int) -> Thing:
        """Return an upright rod that reflects."""
        return Thing("rod", self.at(*foot), (radius, height), material)

    def shining(
        self,
        shape: str,
        centre: Point,
        size: tuple[float, ...],
        light: int,
        level: float,
    ) -> Thing:
        """Return a shape that is a light."""
        place = self.at(*centre)
        return Thing(shape, place, size, light=light, level=level, turn=self.turn)
