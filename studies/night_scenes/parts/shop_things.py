# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Things of shops, arcades and stations. Sizes (x, y, z) in metres; fronts face -y."""

import math
import random

from ..choices.colour import neon_rgb
from .library import facades, geometry, materials, paint, render, steel


def goods_on(rng, x0, x1, y, z, models):
    """Stand goods along x from @x0 to @x1 on a board."""
    while x0 < x1 - 0.1:
        model, wide = rng.choice(models)
        geometry.copy(model, (x0 + wide / 2, y, z))
        x0 += wide + rng.choice((0.005, 0.01, 0.05))


def models_of(rng):
    """Return [(object, width)] of eight packs and tins, parked below the floor."""
    found = []
    for hue in rng.sample(facades.GOODS, 8):
        wide, tall = rng.uniform(0.09, 0.2), rng.uniform(0.14, 0.27)
        points = [(-wide / 2, 0), (wide / 2, 0), (wide / 2, tall), (-wide / 2, tall)]
        pack = geometry.prism("pack", points, 0.16, (0, 0, -9), paint(hue, 0.35))
        found.append((pack, wide))
    return found


def shelf(thing):
    """A shop's shelf along y, goods on both sides."""
    x, y, z = thing.size
    rng, metal = random.Random(thing.seed), paint(thing.shade, 0.4)
    turned = (0, 0, math.pi / 2)
    levels = int((z - 0.15) / 0.36)
    tall = 0.14 + 0.36 * levels
    geometry.box("spine", (0.04, y, tall), (0, 0, tall / 2), metal)
    for level in range(levels):
        height = 0.14 + 0.36 * level
        geometry.box("board", (x, y, 0.03), (0, 0, height), metal)
        for side in (-1, 1):
            along = -y / 2 + 0.08
            while along < y / 2 - 0.1:
                hue, wide = rng.choice(facades.GOODS), rng.uniform(0.1, 0.22)
                run = min(rng.randint(2, 4) * wide, y / 2 - 0.04 - along)
                size = (run, 0.2, rng.uniform(0.14, 0.28))
                place = (
                    side * (x / 2 - 0.14),
                    along + run / 2,
                    height + 0.015 + size[2] / 2,
                )
                geometry.box("goods", size, place, paint(hue, 0.35), turned, edge=0.012)
                along += run + rng.choice((0.01, 0.02, 0.06))


def fridge(thing):
    """A row of lit cooling shelves across x."""
    x, y, z = thing.size
    rng = random.Random(thing.seed)
    white = paint(thing.shade, 0.4)
    geometry.box("back", (x, 0.05, z), (0, y / 2 - 0.03, z / 2), white)
    geometry.box("top", (x, y, 0.1), (0, 0, z), white)
    models = models_of(rng)
    for level in range(5):
        height = 0.12 + 0.4 * level
        geometry.box("board", (x, y - 0.1, 0.03), (0, 0.05, height), white)
        goods_on(rng, -x / 2 + 0.1, x / 2 - 0.1, -0.05, height + 0.016, models)
    for side in (-1, 1):
        geometry.box("side", (0.05, y, z), (side * x / 2, 0, z / 2), white)
    render.light(
        "AREA", (0, -y / 2 + 0.05, z - 0.08), 12.0, 5200, target=(0, 0.1, 0.3),
        shape="RECTANGLE", size=x * 0.9, size_y=0.1,
    )  # fmt: skip


def machine(thing):
    """An upright machine with a lit face: games, tickets."""
    x, y, z = thing.size
    rng, case = random.Random(thing.seed), paint((0.02, 0.02, 0.025), 0.3)
    side = materials.glow("edge", thing.shade, 2.4)
    outline = [(-y / 2 + 0.1, 0), (y / 2, 0), (y / 2, z), (-y / 2 + 0.05, z),
               (-y / 2 + 0.05, z - 0.3), (-0.05, z - 0.4), (-0.1, 1.0), (-y / 2, 0.92),
               (-y / 2 + 0.1, 0.75)]  # fmt: skip
    turn = (0, 0, math.pi / 2)
    geometry.prism("case", outline, x - 0.04, (0, 0, 0), case, turn)
    for at in (-x / 2, x / 2):
        geometry.tube(
            "edge", [(at, -y / 2 + 0.12, 0.1), (at, -y / 2 + 0.06, 0.85)], 0.012, side
        )
    glow = materials.glow(
        "face", neon_rgb(rng.random(), rng.uniform(0.3, 0.9)), 3.0, True
    )
    lean = (-0.1, 0, 0)
    geometry.box("face", (x - 0.16, 0.01, 0.42), (0, -0.10, 1.22), glow, lean, 0.0)
    title = materials.glow("title", thing.shade, 4.0, True)
    geometry.box(
        "title", (x - 0.1, 0.02, 0.22), (0, -y / 2 + 0.05, z - 0.14), title, edge=0
    )


def train(thing):
    """A train at the platform's side, along y, its inside lit."""
    x, y, z = thing.size
    coat = paint(thing.shade, 0.25, Coat_Weight=0.8)
    metal = steel((0.45, 0.46, 0.48), 0.3)
    geometry.box("lower", (x, y, 1.1), (0, 0, 0.6), metal, edge=0.06)
    geometry.box("upper", (x, y, 0.9), (0, 0, z - 0.5), coat, edge=0.15)
    inside = materials.glow("inside", (1.0, 0.86, 0.66), 0.55)
    geometry.box("inside", (0.1, y - 0.5, 1.3), (0, 0, 1.75), inside, edge=0.0)
    tube = materials.glow("tube", (1.0, 0.9, 0.74), 5.0, sampled=True)
    geometry.box("tube", (0.2, y - 0.8, 0.04), (0, 0, 2.38), tube, edge=0.0)
    cloth = paint(tuple(0.5 * c for c in thing.shade), 0.8)
    glass = materials.pane("glass", (0.8, 0.85, 0.85))
    geometry.box("glass", (x - 0.06, y - 0.06, 1.4), (0, 0, 1.75), glass, edge=0.0)
    count = int(y / 1.7)
    for step in range(count + 1):
        at = -y / 2 + 0.1 + step * (y - 0.2) / count
        wide = 0.5 if step % 3 else 0.12
        for side in (-1, 1):
            place = (side * (x / 2 - 0.03), at, 1.75)
            geometry.box("post", (0.07, wide, 1.4), place, metal)
            seat = (side * (x / 2 - 0.45), at + 0.8, 1.3)
            geometry.box("seat", (0.5, 0.9, 0.65), seat, cloth, edge=0.06)
            grip = (side * (x / 2 - 0.75), at + 0.1, 1.75)
            geometry.box("grip", (0.03, 0.03, 1.3), grip, metal)


def column(thing):
    """A square column, tiled."""
    x, y, z = thing.size
    tile = materials.plaster("column", thing.shade, 0.001, 40.0, 0.2)
    geometry.box("column", (x, y, z), (0, 0, z / 2), tile, edge=0.03)
    band = paint((0.4, 0.3, 0.02), 0.5)
    geometry.box("band", (x + 0.02, y + 0.02, 0.25), (0, 0, 0.9), band, edge=0.03)


THINGS = {
    "shelf": shelf,
    "fridge": fridge,
    "machine": machine,
    "train": train,
    "column": column,
}
