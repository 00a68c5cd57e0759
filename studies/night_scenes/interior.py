# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds a room: floor, walls, ceiling, windows."""

import math

from .parts import ground
from .parts.library import geometry, materials, paint

BEHIND = -0.6  # m, the wall behind the camera
FLOORS = {
    "planks": ((0.10, 0.05, 0.022), (0.26, 0.15, 0.07), (1.2, 0.12), 0.002, 0.35),
    "tiles": ((0.30, 0.29, 0.27), (0.36, 0.35, 0.33), (0.4, 0.4), 0.004, 0.2),
    "terrazzo": ((0.26, 0.25, 0.24), (0.30, 0.29, 0.28), (1.2, 1.2), 0.003, 0.15),
}


def flooring(name):
    """Return the floor's material by its name."""
    if name in FLOORS:
        first, second, size, joint, rough = FLOORS[name]
        return ground.blocks(name, 0.0, size, first, second, joint, rough)
    if name == "checks":
        material, nodes = materials.begin("checks")
        place = nodes.coordinates()
        squares = nodes.add("TexChecker", {"Vector": place, "Scale": 1 / 0.4})
        fine = nodes.noise(place, 18.0)
        color = nodes.mix(
            squares.outputs["Fac"], (0.03, 0.03, 0.032), (0.5, 0.48, 0.44)
        )
        materials.finish(nodes, color, nodes.remap(fine, 0.3, 0.7, 0.1, 0.25))
        return material
    if name == "carpet":
        return materials.weave(
            "carpet", (0.10, 0.05, 0.07), (0.07, 0.06, 0.11), 0.02, 0.5
        )
    return materials.plaster("concrete", (0.22, 0.215, 0.20), 0.002, 20.0, 0.4)


def stage(scene):
    """Build the room's shell; its right wall has windows where the plan says so."""
    size = scene.stage
    half, deep, tall = size["width"] / 2, size["depth"], size["height"]
    span = geometry.span
    wall = materials.plaster("wall", tuple(size["wall"]))
    pale = materials.plaster("ceiling", (0.5, 0.49, 0.46))
    span(
        "floor", (-half, BEHIND, -0.1), (half, deep, 0), flooring(size["floor"]), edge=0
    )
    span("ceiling", (-half, BEHIND, tall), (half, deep, tall + 0.1), pale, edge=0)
    span("back", (-half, deep, 0), (half, deep + 0.1, tall), wall, edge=0)
    span("front", (-half, BEHIND - 0.1, 0), (half, BEHIND, tall), wall, edge=0)
    span("left", (-half - 0.1, BEHIND, 0), (-half, deep, tall), wall, edge=0)
    skirting = paint((0.06, 0.05, 0.045), 0.4)
    span("skirting", (-half, BEHIND, 0), (-half + 0.015, deep, 0.1), skirting)
    span("skirting", (-half, deep - 0.015, 0), (half, deep, 0.1), skirting)
    if size["window"]:
        windows(half, deep, tall, wall)
    else:
        span("right", (half, BEHIND, 0), (half + 0.1, deep, tall), wall, edge=0)


def windows(half, deep, tall, wall):
    """The right wall with windows from 0.9 m to 0.3 m below the ceiling."""
    span, low, high = geometry.span, 0.9, tall - 0.3
    frame = paint((0.1, 0.1, 0.1), 0.4)
    span("parapet", (half, BEHIND, 0), (half + 0.2, deep, low), wall, edge=0)
    span("lintel", (half, BEHIND, high), (half + 0.2, deep, tall), wall, edge=0)
    count = max(2, math.floor((deep - BEHIND) / 2.0))
    step = (deep - BEHIND) / count
    for number in range(count + 1):
        y = BEHIND + number * step
        span("pier", (half, y - 0.2, low), (half + 0.2, y + 0.2, high), wall, edge=0)
        if number < count:
            middle = y + step / 2
            low_bar = (half + 0.08, middle - 0.03, low)
            span("bar", low_bar, (half + 0.13, middle + 0.03, high), frame)
    glass = materials.pane("window")
    span("window", (half + 0.1, BEHIND, low), (half + 0.11, deep, high), glass, edge=0)
