# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Neon and lit boards. Each is built facing -y at the origin, and then moved."""

import math

from ..choices.colour import neon_rgb
from .library import geometry, group, materials, paint, render, steel

FACE = (math.pi / 2, 0.0, 0.0)  # turns what lies in x, y upright, facing -y
BOARD = (0.015, 0.015, 0.018)


def text(words, size, glow, location, rotation, wide=0.013):
    """Add lettering that is legible from -y."""
    geometry.lettering("neon", words, size, wide, glow, location, rotation)


def letters(sign, glow, hue):
    """Letters flat on the wall."""
    text(sign.text, sign.size, glow, (0, -0.08, 0), FACE, 0.022 * sign.size + 0.003)


def two_sided(words, sign, glow, board):
    """A board that stands off the wall, lettered on both sides."""
    wide, tall = board
    middle = (0, -0.25 - wide / 2, 0)
    geometry.box("board", (0.08, wide, tall), middle, paint(BOARD, 0.25), edge=0.012)
    geometry.box("arm", (0.04, 0.3, 0.04), (0, -0.13, tall / 3), steel())
    for side in (-1, 1):
        turn = (math.pi / 2, 0, side * math.pi / 2)
        text(words, sign.size, glow, (side * 0.06, middle[1], 0), turn)


def blade(sign, glow, hue):
    """A short word on a board across the pavement."""
    size = min(sign.size, 1.0 / (0.62 * len(sign.text)))
    one = type(sign)(**{**vars(sign), "size": size})
    board = (0.78 * size * len(sign.text) + 0.1, 1.5 * size)
    two_sided(sign.text, one, glow, board)


def column(sign, glow, hue):
    """A word from top to bottom."""
    tall = 0.98 * sign.size * len(sign.text)
    two_sided("\n".join(sign.text), sign, glow, (1.1 * sign.size, tall))


def ring(sign, glow, hue):
    """Two circles on the wall."""
    for radius in (0.62 * sign.size + 0.2, 0.5 * sign.size + 0.12):
        points = [
            (radius * math.sin(a), -0.08, radius * math.cos(a))
            for a in (2 * math.pi * step / 24 for step in range(25))
        ]
        geometry.tube("ring", points, 0.014, glow)


def strip(sign, glow, hue):
    """A straight tube along the wall."""
    geometry.tube("strip", [(-1.2, -0.06, 0), (1.2, -0.06, 0)], 0.016, glow)


def screen(sign, glow, hue):
    """A board of light diodes with a picture of coloured noise."""
    wide, tall = 3.4, 2.2
    material, nodes = materials.begin("screen")
    place = nodes.coordinates((0.55, 0.55, 0.8))
    shifted = nodes.add("Mapping", {"Vector": place, "Location": sign.place}).outputs[0]
    field = nodes.noise(shifted, 1.0, 3.0, 0.6, 1.5)
    second = neon_rgb(sign.hue + 0.33, 0.9)
    stops = [(0.35, (0.02, 0.02, 0.03)), (0.45, hue), (0.6, second), (0.7, (1, 1, 1))]
    color = nodes.ramp(field, stops)
    strength = sign.radiance * 0.16
    nodes.output(
        nodes.add("Emission", {"Color": color, "Strength": strength}).outputs[0]
    )
    material.cycles.emission_sampling = "FRONT"
    geometry.box("case", (wide + 0.2, 0.16, tall + 0.2), (0, -0.1, 0), paint(BOARD))
    geometry.box("screen", (wide, 0.02, tall), (0, -0.2, 0), material, edge=0.0)


SIGNS = {
    "letters": letters,
    "blade": blade,
    "column": column,
    "ring": ring,
    "strip": strip,
    "screen": screen,
}


def build(signs):
    """Build all signs; a light of their hue before them stands for their spill."""
    for sign in signs:
        hue = neon_rgb(sign.hue, sign.saturation)
        with group(sign.place, sign.turn):
            glow = materials.glow("neon", hue, sign.radiance)
            SIGNS[sign.name](sign, glow, hue)
            if sign.name != "screen":
                power = sign.radiance * sign.size * len(sign.text) * 0.5
                render.light(
                    "POINT", (0, -0.7, 0), power, color=hue, shadow_soft_size=0.4
                )
