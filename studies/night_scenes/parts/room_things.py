# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Furniture of bars and diners. Sizes (x, y, z) in metres; fronts face -y."""

import math
import random

from ..choices.colour import neon_rgb
from .library import facades, geometry, materials, paint, render, steel


def counter(thing):
    """A counter with an overhanging top."""
    x, y, z = thing.size
    front = paint(thing.shade, 0.45)
    geometry.box("counter", (x, y, z - 0.06), (0, 0, z / 2 - 0.03), front, edge=0.01)
    top = paint(tuple(0.4 * c for c in thing.shade), 0.12)
    geometry.box("top", (x + 0.16, y + 0.1, 0.06), (0, 0, z - 0.03), top, edge=0.01)


def bottles(thing):
    """Lit shelves of bottles against a wall; they look to -x before the turn."""
    x, y, z = thing.size
    rng = random.Random(thing.seed)
    wood = paint(thing.shade, 0.4)
    geometry.box("back", (0.04, y, z), (x / 2, 0, z / 2), wood)
    hue = neon_rgb(rng.random(), rng.uniform(0.0, 0.9))
    glow = materials.glow("strip", hue, 5.0, sampled=True)
    glasses = [
        materials.glass("bottle", tint)
        for tint in (
            (0.1, 0.4, 0.12),
            (0.6, 0.25, 0.04),
            (0.9, 0.9, 0.88),
            (0.3, 0.4, 0.7),
        )
    ]
    models = []
    for number, glass in enumerate(glasses):
        wide = 0.034 + 0.004 * number
        profile = [
            (0, 0),
            (wide, 0),
            (wide, 0.19),
            (0.013, 0.24),
            (0.013, 0.31),
            (0, 0.31),
        ]
        models.append(
            geometry.lathe("bottle", profile, (x / 2, 0, -9), glass, segments=14)
        )
    for height in (1.05, 1.5, 1.95):
        geometry.box("shelf", (x, y, 0.03), (0, 0, height), wood)
        geometry.box(
            "strip", (0.02, y, 0.03), (x / 2 - 0.04, 0, height + 0.03), glow, edge=0
        )
        along = -y / 2 + 0.1
        while along < y / 2 - 0.1:
            place = (rng.uniform(-0.08, 0.05), along, height + 0.016)
            geometry.copy(rng.choice(models), place)
            along += rng.choice((0.09, 0.1, 0.11, 0.2))
    geometry.box("base", (x, y, 0.9), (0, 0, 0.45), wood)


def stool(thing):
    """A bar stool."""
    tall = thing.size[2]
    geometry.cylinder(
        "seat", 0.18, 0.07, (0, 0, tall - 0.07), paint(thing.shade, 0.4), edge=0.02
    )
    geometry.cylinder("stem", 0.025, tall - 0.06, (0, 0, 0), steel((0.4, 0.4, 0.4)))
    geometry.cylinder("foot", 0.2, 0.03, (0, 0, 0), steel((0.4, 0.4, 0.4)))


def chair(x, y, turn, wood):
    """A plain chair that looks to the middle of its table."""
    c, s = math.cos(turn), math.sin(turn)
    geometry.box("seat", (0.4, 0.4, 0.04), (x, y, 0.45), wood, (0, 0, turn))
    back = (x + 0.19 * c, y + 0.19 * s, 0.7)
    geometry.box("back", (0.03, 0.4, 0.45), back, wood, (0, 0, turn))
    for i in (-0.16, 0.16):
        for j in (-0.16, 0.16):
            place = (x + i * c - j * s, y + i * s + j * c, 0.22)
            geometry.box("leg", (0.035, 0.035, 0.44), place, wood, (0, 0, turn))


def table(thing):
    """A round table with glasses, a candle and two or three chairs."""
    rng, wood = random.Random(thing.seed), paint(thing.shade, 0.35)
    geometry.cylinder("top", 0.42, 0.03, (0, 0, 0.72), wood)
    geometry.cylinder("stem", 0.04, 0.72, (0, 0, 0), steel())
    geometry.cylinder("foot", 0.24, 0.03, (0, 0, 0), steel())
    for turn in rng.sample((0.2, 1.8, 3.4, 5.0), rng.randint(2, 3)):
        chair(0.55 * math.cos(turn), 0.55 * math.sin(turn), turn, wood)
    drink = materials.plain(
        "drink", rng.choice(((0.6, 0.3, 0.03), (0.4, 0.02, 0.03))), 0.1
    )
    for x, y in ((0.2, 0.1), (-0.18, 0.12), (0.02, -0.22)):
        geometry.cylinder("drink", 0.033, rng.uniform(0.08, 0.14), (x, y, 0.751), drink)
    flame = materials.glow("candle", (1.0, 0.4, 0.08), 40.0)
    geometry.cylinder("candle", 0.025, 0.07, (0, 0.02, 0.75), paint((0.6, 0.57, 0.5)))
    geometry.ball("flame", 0.013, (0, 0.02, 0.845), flame, 1.8)
    render.light("POINT", (0, 0.02, 0.87), 0.9, 1900, shadow_soft_size=0.02)


def booth(thing):
    """Two padded benches with a table between, along y."""
    x, y, z = thing.size
    pad = paint(thing.shade, 0.35, Coat_Weight=0.4)
    for side in (-1, 1):
        at = side * (y / 2 - 0.24)
        geometry.box("seat", (x, 0.46, 0.45), (0, at, 0.225), pad, edge=0.05)
        back = (0, side * (y / 2 - 0.06), z / 2)
        geometry.box("back", (x, 0.12, z), back, pad, edge=0.05)
    top = paint((0.5, 0.48, 0.44), 0.2)
    geometry.box("top", (x - 0.1, 0.62, 0.04), (0, 0, 0.74), top, edge=0.01)
    geometry.cylinder("stem", 0.05, 0.73, (0, 0, 0), steel((0.4, 0.4, 0.4)))
    rng = random.Random(thing.seed)
    for at in (-0.4, 0.3):
        hue = rng.choice(facades.GOODS)
        geometry.cylinder("cup", 0.04, 0.1, (at, 0.1, 0.76), paint(hue, 0.2))
        geometry.cylinder(
            "plate", 0.11, 0.015, (at, -0.12, 0.76), paint((0.7, 0.69, 0.66))
        )


THINGS = {
    "counter": counter,
    "bottles": bottles,
    "stool": stool,
    "table": table,
    "booth": booth,
}
