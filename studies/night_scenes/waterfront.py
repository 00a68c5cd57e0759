# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds quays, a canal or a bridge's deck, and the water."""

from .choices.waterfront import EDGE
from .parts import ground
from .parts.library import geometry, materials


def stage(scene):
    """Build the ground of a river, a canal or a deck, by the stage's plan."""
    PLANS[scene.stage["plan"]](scene.stage, scene.weather.wet)


def stone():
    """Return the walls of quays."""
    return materials.plaster("quay", (0.16, 0.15, 0.135), 0.01, 10.0, 0.5)


def river(size, wet):
    """The near quay, the river, and the far bank."""
    far, level = size["far"], size["water"]
    span, wall = geometry.span, stone()
    paving = ground.slabs(wet)
    span("quay", (-60, -14, level - 1), (60, EDGE - 0.3, 0), paving, edge=0.0)
    span("edge", (-60, EDGE - 0.3, level - 1), (60, EDGE, 0.02), wall, edge=0.02)
    span("bank", (-160, far, level - 1), (160, far + 70, 0), wall, edge=0.0)
    ground.water(level, -160, 160, EDGE, far)


def canal(size, wet):
    """Water between two quays with houses."""
    half, wall, level = size["canal"], size["wall"], size["water"]
    span, edge, paving = geometry.span, stone(), ground.cobbles(wet)
    for side in (-1, 1):
        low, high = sorted((side * (half + 0.3), side * (wall + 1.8)))
        span("quay", (low, -14, level - 1), (high, 74, 0), paving, edge=0.0)
        low, high = sorted((side * half, side * (half + 0.3)))
        span("edge", (low, -14, level - 1), (high, 74, 0.02), edge, edge=0.02)
    span("end", (-60, 66, level - 1), (60, 90, 0.0), edge, edge=0.0)
    span("bridge", (-half, -14, -0.6), (half, -1.2, 0.0), paving, edge=0.0)
    ground.water(level, -half, half, -14, 66, 0.6)


def deck(size, wet):
    """A bridge's road and pavements high over the water, and both banks."""
    half, edge, level = size["deck"], size["parapet"], size["water"]
    span, wall = geometry.span, stone()
    span("road", (-half, -30, -0.8), (half, 140, 0), ground.asphalt(wet), edge=0.0)
    paving, line = ground.slabs(wet), ground.paint_line(wet)
    for side in (-1, 1):
        low, high = sorted((side * half, side * (edge + 0.2)))
        span("pavement", (low, -30, -0.9), (high, 100, 0.13), paving, edge=0.02)
    for step in range(16):
        y = 8 + step * 5.2
        span("dash", (-0.07, y, -0.01), (0.07, y + 2.4, 0.003), line, edge=0.0)
    span("bank", (-200, 74, level - 1), (200, 160, -0.9), wall, edge=0.0)
    ground.water(level, -200, 200, -60, 74)


PLANS = {"river": river, "canal": canal, "deck": deck}
