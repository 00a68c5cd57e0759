# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How rooms are furnished: each function puts things down and returns them."""

import math

from . import crowd
from .colour import neon_rgb


def bar(rng, ground, width, depth):
    """Draw a counter with stools and bottles behind it, and tables opposite."""
    side = rng.choice((-1, 1))
    wood = rng.choice(((0.14, 0.06, 0.025), (0.05, 0.03, 0.02), (0.22, 0.12, 0.06)))
    x, long = side * (width / 2 - 1.35), depth - 3.4
    y = 2.6 + long / 2
    things = crowd.put(rng, ground, "counter", x, y, 0.0, (0.6, long, 1.1), wood)
    shelf = side * (width / 2 - 0.2)
    size = (0.36, long, 2.3)
    turn = 0.0 if side > 0 else math.pi
    things += crowd.put(rng, ground, "bottles", shelf, y, turn, size, wood)
    step = 2.9
    while step < 2.2 + long:
        spot, size = x - side * 0.62, (0.4, 0.4, 0.78)
        things += crowd.put(
            rng, ground, "stool", spot, step, 0.0, size, (0.3, 0.03, 0.03)
        )
        step += rng.uniform(0.75, 1.3)
    area = sorted((-side * (width / 2 - 0.9), side * 0.2))
    return things + crowd.scatter(
        rng, ground, "table", 5, (*area, 2.8, depth - 0.8), (1.5, 1.5, 0.75), wood
    )


def booths(rng, ground, width, depth):
    """Draw a diner: booths along both walls and a counter at the back."""
    seat = tuple(0.03 + 0.4 * c for c in neon_rgb(rng.random(), 0.9))
    things = []
    for side in (-1, 1):
        y = 2.4
        while y < depth - 2.6:
            x = side * (width / 2 - 0.95)
            things += crowd.put(rng, ground, "booth", x, y, 0.0, (1.7, 1.9, 1.15), seat)
            y += 2.05
    size = (width - 2.4, 0.6, 1.1)
    return things + crowd.put(
        rng, ground, "counter", 0.0, depth - 1.4, 0.0, size, (0.45, 0.44, 0.42)
    )


def aisles(rng, ground, width, depth):
    """Draw a shop's shelves in aisles and its till."""
    things, x = [], -width / 2 + 0.4
    grey = (0.35, 0.35, 0.34)
    while x < width / 2 - 0.2:
        y = 3.2
        while y < depth - 3:
            size = (0.7, 2.6, rng.choice((1.5, 1.9)))
            if rng.random() < 0.9:
                things += crowd.put(rng, ground, "shelf", x, y + 1.3, 0.0, size, grey)
            y += 2.65
        x += rng.uniform(1.9, 2.3)
    size = (width - 1.0, 0.6, 2.1)
    return things + crowd.put(
        rng, ground, "fridge", 0.0, depth - 0.35, 0.0, size, (0.6, 0.6, 0.6)
    )


def desks(rng, ground, width, depth):
    """Draw an office: desks in rows with lit screens."""
    things = []
    for y in [2.8 + 2.3 * step for step in range(int((depth - 4) / 2.3))]:
        for x in [-width / 2 + 1.6 + 2.0 * c for c in range(int((width - 2) / 2.0))]:
            if rng.random() < 0.85:
                turn, size = rng.choice((0.0, math.pi)), (1.6, 1.5, 0.74)
                things += crowd.put(
                    rng, ground, "desk", x, y, turn, size, (0.5, 0.42, 0.3)
                )
    return things


def lounge(rng, ground, width, depth):
    """Draw a living room: sofa, low table, television, shelf, lamp, plant."""
    cloth = rng.choice(((0.25, 0.2, 0.15), (0.05, 0.1, 0.16), (0.3, 0.08, 0.05)))
    wood = (0.2, 0.11, 0.05)
    back = depth - 0.35
    sofa = width / 2 - 0.55
    side = rng.choice((-1, 1))
    spots = (
        ("television", rng.uniform(-0.6, 0.6), back, 0.0, (1.6, 0.4, 1.4), wood),
        (
            "sofa",
            side * sofa,
            depth * 0.55,
            -side * math.pi / 2,
            (2.1, 0.9, 0.8),
            cloth,
        ),
        ("low_table", 0.1, depth * 0.55, 0.0, (0.7, 1.1, 0.42), wood),
        ("floor_lamp", side * sofa, depth * 0.55 + 1.6, 0.0, (0.5, 0.5, 1.6), wood),
        (
            "bookcase",
            -side * sofa,
            depth * 0.7,
            side * math.pi / 2,
            (1.5, 0.35, 2),
            wood,
        ),
        ("plant", -side * sofa, back - 0.3, 0.0, (0.6, 0.6, 1.1), (0.04, 0.15, 0.03)),
    )
    return [
        made
        for name, x, y, turn, size, shade in spots
        for made in crowd.put(rng, ground, name, x, y, turn, size, shade)
    ]


def machines(rng, ground, width, depth):
    """Draw an arcade's machines along the walls and back to back."""
    things = []
    for x, turn in (
        (-width / 2 + 0.55, math.pi / 2),
        (width / 2 - 0.55, -math.pi / 2),
        (-0.5, -math.pi / 2),
        (0.5, math.pi / 2),
    ):
        y = 3.2
        while y < depth - 1.2:
            shade, size = neon_rgb(rng.random(), 0.95), (0.8, 0.85, 1.8)
            if rng.random() < 0.9:
                things += crowd.put(rng, ground, "machine", x, y, turn, size, shade)
            y += rng.uniform(0.95, 1.2)
    return things


def platform(rng, ground, width, depth):
    """Draw a platform: columns, benches, ticket machines, and a train at its side."""
    shade = tuple(0.05 + 0.4 * c for c in neon_rgb(rng.random(), 0.9))
    things = []
    if rng.random() < 0.7:
        x = width / 2 - 1.75
        size = (2.9, depth - 5, 3.3)
        things += crowd.put(rng, ground, "train", x, depth / 2 + 1.5, 0.0, size, shade)
    for y in range(5, int(depth) - 2, 5):
        tile, size = (0.45, 0.44, 0.4), (0.6, 0.6, 5.4)
        things += crowd.put(rng, ground, "column", -0.8, y, 0.0, size, tile)
    area, bench = (-width / 2 + 0.6, 1.5, 4.0, depth - 4), (1.8, 0.6, 0.85)
    things += crowd.scatter(
        rng, ground, "bench", 4, area, bench, (0.2, 0.11, 0.05), False
    )
    x, size = -width / 2 + 0.4, (0.8, 0.7, 1.8)
    for y in (7.0, 8.1):
        turn, hue = math.pi / 2, neon_rgb(rng.random(), 0.9)
        things += crowd.put(rng, ground, "machine", x, y, turn, size, hue)
    return things


def pillars(rng, ground, width, depth):
    """Draw the columns of a garage."""
    found = []
    for y in range(6, int(depth), 6):
        for x in (-2.9, 2.9):
            size, shade = (0.45, 0.45, 3.0), (0.4, 0.38, 0.34)
            found += crowd.put(rng, ground, "column", x, y, 0.0, size, shade)
    return found


FURNISH = {
    "bar": bar,
    "station": platform,
    "shop": aisles,
    "diner": booths,
    "office": desks,
    "living room": lounge,
    "arcade": machines,
    "garage": pillars,
}
