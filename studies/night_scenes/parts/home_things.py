# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Furniture of homes and offices. Sizes (x, y, z) in metres; fronts face -y."""

import math
import random

from ..choices.colour import neon_rgb
from .library import facades, geometry, materials, paint, render, steel
from .street_things import leaves


def desk(thing):
    """A desk with a screen, a keyboard and a chair."""
    rng, wood = random.Random(thing.seed), paint(thing.shade, 0.4)
    dark = paint((0.015, 0.015, 0.017), 0.35)
    geometry.box("top", (1.5, 0.7, 0.03), (0, -0.3, 0.72), wood)
    for side in (-1, 1):
        geometry.box("side", (0.04, 0.66, 0.7), (side * 0.7, -0.3, 0.35), wood)
    geometry.box("screen", (0.62, 0.04, 0.38), (0, -0.5, 1.03), dark, edge=0.008)
    geometry.box("stand", (0.08, 0.06, 0.2), (0, -0.5, 0.82), dark)
    lit = rng.random() < 0.55
    hue = rng.choice(
        ((0.55, 0.75, 1.0), (0.9, 0.95, 1.0), (0.2, 0.5, 1.0), (0.3, 0.9, 0.6))
    )
    glow = materials.glow("picture", hue, 1.6 if lit else 0.003, sampled=lit)
    geometry.box("picture", (0.58, 0.01, 0.34), (0, -0.477, 1.03), glow, edge=0)
    geometry.box("keys", (0.42, 0.14, 0.02), (0, -0.2, 0.745), dark)
    cloth = paint((0.04, 0.05, 0.07), 0.8)
    turn = rng.uniform(-0.7, 0.7)
    geometry.box("seat", (0.48, 0.48, 0.08), (0, 0.35, 0.47), cloth, (0, 0, turn), 0.03)
    place = (-0.22 * math.sin(turn), 0.35 + 0.22 * math.cos(turn), 0.8)
    geometry.box("back", (0.44, 0.06, 0.55), place, cloth, (0, 0, turn), 0.03)
    geometry.cylinder("stem", 0.03, 0.44, (0, 0.35, 0), steel())
    geometry.cylinder("foot", 0.28, 0.05, (0, 0.35, 0), steel())


def television(thing):
    """A television on a low board; its picture is coloured noise."""
    x, y, _ = thing.size
    wood, dark = paint(thing.shade, 0.4), paint((0.012,) * 3, 0.3)
    geometry.box("board", (x, y, 0.45), (0, 0, 0.225), wood, edge=0.01)
    geometry.box("case", (1.3, 0.06, 0.76), (0, 0.05, 0.9), dark, edge=0.01)
    material, nodes = materials.begin("picture")
    scaled = nodes.coordinates((2.4, 2.4, 3.0))
    moved = {"Vector": scaled, "Location": (thing.seed % 97, 0, 0)}
    place = nodes.add("Mapping", moved).outputs[0]
    first = random.Random(thing.seed).random()
    hues = [neon_rgb(first + k / 3, 0.7) for k in range(3)]
    field = nodes.noise(place, 1.0, 3.0, 0.5, 1.0)
    color = nodes.ramp(field, list(zip((0.35, 0.5, 0.65), hues, strict=True)))
    nodes.output(nodes.add("Emission", {"Color": color, "Strength": 3.0}).outputs[0])
    material.cycles.emission_sampling = "FRONT"
    geometry.box("picture", (1.24, 0.01, 0.70), (0, 0.015, 0.9), material, edge=0)


def sofa(thing):
    """A sofa with two arms, facing -y."""
    x, y, _ = thing.size
    cloth = materials.weave(
        "cloth", thing.shade, tuple(1.3 * c for c in thing.shade), 0.01
    )
    geometry.box("seat", (x - 0.3, y - 0.2, 0.4), (0, -0.05, 0.22), cloth, edge=0.06)
    geometry.box("back", (x, 0.24, 0.8), (0, y / 2 - 0.12, 0.42), cloth, edge=0.08)
    for side in (-1, 1):
        place = (side * (x / 2 - 0.1), -0.02, 0.3)
        geometry.box("arm", (0.2, y - 0.05, 0.58), place, cloth, edge=0.06)
        pillow = paint((0.4, 0.3, 0.1), 0.8)
        spot = (side * (x / 2 - 0.45), y / 2 - 0.32, 0.56)
        geometry.box("pillow", (0.42, 0.14, 0.4), spot, pillow, (0.3, 0, 0), 0.06)


def low_table(thing):
    """A low table with a book and a cup."""
    x, y, z = thing.size
    wood = paint(thing.shade, 0.35)
    geometry.box("top", (x, y, 0.04), (0, 0, z), wood)
    for i in (-1, 1):
        for j in (-1, 1):
            place = (i * (x / 2 - 0.05), j * (y / 2 - 0.05), z / 2)
            geometry.box("leg", (0.05, 0.05, z), place, wood)
    geometry.box(
        "book", (0.16, 0.23, 0.03), (0.05, 0.2, z + 0.035), paint((0.3, 0.03, 0.03))
    )
    geometry.cylinder(
        "cup", 0.04, 0.09, (-0.1, -0.15, z + 0.02), paint((0.6, 0.6, 0.58))
    )


def floor_lamp(thing):
    """A standard lamp with a cloth shade."""
    tall = thing.size[2]
    kelvin = random.Random(thing.seed).uniform(2000, 2900)
    linen = materials.weave("linen", (0.85, 0.74, 0.56), (0.66, 0.54, 0.37), 0.006,
                            translucent=0.4)  # fmt: skip
    geometry.cylinder("foot", 0.16, 0.03, (0, 0, 0), steel())
    geometry.cylinder("stem", 0.012, tall - 0.1, (0, 0, 0), steel())
    shade = [(0.23, 0), (0.15, 0.3), (0.148, 0.3), (0.228, 0), (0.23, 0)]
    geometry.lathe("shade", shade, (0, 0, tall - 0.3), linen)
    render.light("POINT", (0, 0, tall - 0.15), 16.0, kelvin, shadow_soft_size=0.05)


def bookcase(thing):
    """Shelves of books, open to -y."""
    x, y, z = thing.size
    rng, wood = random.Random(thing.seed), paint(thing.shade, 0.45)
    geometry.box("back", (x, 0.02, z), (0, y / 2, z / 2), wood)
    for side in (-1, 1):
        geometry.box("side", (0.03, y, z), (side * x / 2, 0, z / 2), wood)
    for level in range(6):
        height = 0.05 + level * (z - 0.08) / 5
        geometry.box("board", (x, y, 0.025), (0, 0, height), wood)
        at = -x / 2 + 0.04
        while at < x / 2 - 0.08 and level < 5:
            thick, tall = rng.uniform(0.02, 0.06), rng.uniform(0.18, 0.3)
            place = (at + thick / 2, 0.02, height + 0.0125 + tall / 2)
            color = paint(rng.choice(facades.GOODS), 0.7)
            geometry.box("book", (thick, 0.2, tall), place, color, edge=0.002)
            at += thick + rng.choice((0.001, 0.001, 0.03))


def plant(thing):
    """A plant in a pot."""
    tall = thing.size[2]
    pot = [(0, 0), (0.15, 0), (0.2, 0.35), (0.18, 0.35), (0.16, 0.3), (0, 0.3)]
    geometry.lathe("pot", pot, (0, 0, 0), paint((0.4, 0.15, 0.08), 0.6), segments=24)
    clump = leaves(random.Random(thing.seed), 240, 0.55, paint(thing.shade, 0.4))
    clump.location = (0, 0, tall * 0.75)
    geometry.cylinder("stalk", 0.02, tall * 0.5, (0, 0, 0.3), paint((0.1, 0.08, 0.03)))


THINGS = {
    "desk": desk,
    "television": television,
    "sofa": sofa,
    "low_table": low_table,
    "floor_lamp": floor_lamp,
    "bookcase": bookcase,
    "plant": plant,
}
