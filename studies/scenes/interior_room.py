# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Walls, floor, windows and garden of the interior. Lengths in metres."""

import math
import random

import scene_geometry as geometry
import scene_materials as materials

LEFT, RIGHT, FRONT, BACK, CEILING = -1.7, 1.7, -1.8, 3.1, 2.6
WINDOWS_Y = ((-0.75, 0.45), (1.55, 2.65))  # the first is behind the camera
WINDOW_Z = (0.92, 2.12)


def shell():
    """Walls with the window opening, ceiling, plank floor, skirting."""
    wall = materials.plaster("wall", (0.52, 0.56, 0.50))
    side = materials.plaster("side_wall", (0.70, 0.67, 0.60))
    white = materials.plain("white_paint", (0.78, 0.77, 0.74), 0.35)
    span = geometry.span
    span("back", (LEFT, BACK, 0), (RIGHT, BACK + 0.1, CEILING), wall)
    span("front", (LEFT, FRONT - 0.1, 0), (RIGHT, FRONT, CEILING), side)
    span("right", (RIGHT, FRONT, 0), (RIGHT + 0.1, BACK, CEILING), side)
    span("ceiling", (LEFT, FRONT, CEILING), (RIGHT, BACK, CEILING + 0.1), white)
    outer, (z0, z1) = LEFT - 0.16, WINDOW_Z
    pillars = [FRONT, *WINDOWS_Y[0], *WINDOWS_Y[1], BACK]
    for y0, y1 in zip(pillars[0::2], pillars[1::2], strict=True):
        span("pillar", (outer, y0, 0), (LEFT, y1, CEILING), side, edge=0.0)
    for y0, y1 in WINDOWS_Y:
        span("parapet", (outer, y0, 0), (LEFT, y1, z0), side, edge=0.0)
        span("lintel", (outer, y0, z1), (LEFT, y1, CEILING), side, edge=0.0)
    span("skirting", (LEFT, BACK - 0.015, 0), (RIGHT, BACK, 0.1), white)
    span("skirting", (LEFT, FRONT, 0), (LEFT + 0.015, BACK, 0.1), white)
    span("floor", (LEFT, FRONT, -0.05), (RIGHT, BACK, 0), planks(), edge=0.0)


def planks():
    """Oak boards, 0.12 m wide, each with its own tone and grain."""
    material, nodes = materials.begin("planks")
    position = nodes.coordinates(space="Object")
    bricks = nodes.add(
        "TexBrick",
        {
            "Vector": position,
            "Color1": (0, 0, 0),
            "Color2": (1, 1, 1),
            "Scale": 1.0,
            "Mortar": (0.5, 0.5, 0.5),
            "Mortar Size": 0.0015,
            "Brick Width": 1.1,
            "Row Height": 0.12,
        },
        offset=0.37,
    )
    tone = bricks.outputs["Color"]
    offset = nodes.mix(1.0, tone, (37, 23, 11), "MULTIPLY")
    shifted = nodes.add(
        "VectorMath",
        {0: nodes.coordinates((1.0, 11.0, 11.0)), 1: offset},
        operation="ADD",
    )
    grain = nodes.noise(shifted.outputs[0], 1.5, 8.0, 0.65, 0.9)
    pores = nodes.noise(shifted.outputs[0], 30.0, 3.0, 0.7)
    color = nodes.ramp(
        grain,
        [
            (0.3, (0.10, 0.045, 0.018)),
            (0.5, (0.24, 0.125, 0.055)),
            (0.72, (0.36, 0.21, 0.10)),
        ],
    )
    color = nodes.mix(nodes.remap(pores, 0.5, 0.8, 0.0, 0.6), color, (0.05, 0.02, 0.01))
    color = nodes.mix(
        0.45, color, nodes.mix(tone, (0.13, 0.06, 0.025), (0.4, 0.24, 0.12))
    )
    color = nodes.mix(bricks.outputs["Fac"], color, (0.012, 0.008, 0.005))
    depth = nodes.math(
        "SUBTRACT", nodes.math("MULTIPLY", pores, 0.3), bricks.outputs["Fac"]
    )
    rough = nodes.remap(pores, 0.4, 0.7, 0.28, 0.48)
    materials.finish(nodes, color, rough, nodes.bump(depth, 0.0015, 0.6))
    return material


def window():
    """White sash bars, sill, two linen curtains on a rod."""
    white = materials.plain("sash_paint", (0.80, 0.79, 0.76), 0.3)
    (y0, y1), (z0, z1) = WINDOWS_Y[1], WINDOW_Z
    x, bar = LEFT - 0.09, 0.045
    for y, width in ((y0, bar), (y1, bar), ((y0 + y1) / 2, 0.06)):
        geometry.box("stile", (0.05, width, z1 - z0), (x, y, (z0 + z1) / 2), white)
    for z, width in ((z0, bar), (z1, bar), (z0 + 0.62 * (z1 - z0), 0.028)):
        geometry.box("rail", (0.045, y1 - y0, width), (x, (y0 + y1) / 2, z), white)
    geometry.box(
        "sill",
        (0.22, y1 - y0 + 0.12, 0.03),
        (LEFT + 0.02, (y0 + y1) / 2, z0 - 0.02),
        white,
    )
    linen = materials.weave(
        "curtain", (0.72, 0.66, 0.55), (0.58, 0.51, 0.40), 0.006, translucent=0.35
    )
    brass = materials.metal("rod_brass", (0.7, 0.48, 0.2), 0.2)
    geometry.tube(
        "rod",
        [(LEFT + 0.09, y0 - 0.4, 2.27), (LEFT + 0.09, BACK - 0.03, 2.27)],
        0.011,
        brass,
    )
    for low, high in ((y0 - 0.35, y0 + 0.06), (y1 - 0.06, y1 + 0.36)):
        curtain(low, high, linen)


def curtain(low, high, linen):
    """One curtain between two y positions, in folds that loosen towards the floor."""

    def surface(u, v):
        fold = math.sin(u * 41.0 + 1.3 * math.sin(5.0 * v)) + 0.4 * math.sin(u * 17 + 2)
        reach = 0.018 + 0.02 * (1 - v)
        return LEFT + 0.09 + reach * fold, low + (high - low) * u, 0.03 + 2.22 * v

    geometry.sheet("curtain", surface, 220, 60, linen)


def garden():
    """What the window shows: lawn, hedge and trees under the sky."""
    grass = materials.plaster("lawn", (0.10, 0.19, 0.035), 0.05, 20.0)
    leaf = materials.plaster("foliage", (0.045, 0.12, 0.018), 0.2, 6.0, 0.6)
    geometry.span("lawn", (-40, -30, -0.6), (LEFT - 0.5, 40, -0.5), grass, edge=0.0)
    clump = geometry.ball("clump", 1.0, (0, 0, -40), leaf)
    rng = random.Random(3)
    for _ in range(22):
        x, y = rng.uniform(-34, -16), rng.uniform(0, 42)
        radius = rng.uniform(0.8, 1.9)
        height = rng.uniform(0.2, 1.4)
        for _ in range(170):
            size = radius * rng.uniform(0.10, 0.26)
            around, up = rng.uniform(0, 2 * math.pi), rng.uniform(-1, 1)
            out = radius * math.sqrt(1 - up * up) * rng.uniform(0.8, 1.05)
            twin = geometry.copy(
                clump,
                (
                    x + out * math.cos(around),
                    y + out * math.sin(around),
                    height + 1.2 * radius * up,
                ),
            )
            twin.scale = (size, size, size * rng.uniform(0.7, 1.1))
