# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Things of squares and markets. Sizes (x, y, z) in metres; fronts face -y."""

import math
import random

from ..choices.colour import neon_rgb
from .library import facades, geometry, materials, paint, render, steel
from .street_things import leaves


def stall(thing):
    """A market stall: table of goods under an awning on four posts."""
    x, y, z = thing.size
    rng, wood = random.Random(thing.seed), paint((0.16, 0.09, 0.045), 0.7)
    cloth = materials.weave("awning", thing.shade, (0.6, 0.58, 0.52), 0.3)
    for i in (-1, 1):
        for j in (-1, 1):
            place = (i * (x / 2 - 0.06), j * (y / 2 - 0.06), z / 2 - 0.1)
            geometry.box("post", (0.06, 0.06, z - 0.2), place, wood)
    geometry.box("table", (x - 0.1, y * 0.5, 0.06), (0, -y * 0.15, 0.86), wood)
    geometry.box("apron", (x - 0.1, 0.03, 0.8), (0, -y * 0.4, 0.44), cloth)
    front, back = -y / 2 - 0.35, y / 2 + 0.1
    upper = [(front, z - 0.45), (0.0, z + 0.25), (back, z - 0.3)]
    outline = upper + [(x0, z0 - 0.03) for x0, z0 in upper[::-1]]
    turn = (0, 0, math.pi / 2)
    geometry.prism("roof", outline, x + 0.3, (0, 0, 0), cloth, turn)
    hues = rng.sample(facades.GOODS, 5)
    columns = 9
    for column in range(columns):
        fruit = paint(hues[column * 5 // columns], 0.45)
        for row in range(3):
            place = (
                (column + 0.5) * (x - 0.4) / columns - x / 2 + 0.2,
                -y * 0.32 + 0.28 * row,
                0.97 + 0.05 * row,
            )
            size = rng.uniform(0.09, 0.13)
            if hues[0][0] > 0.3:
                geometry.box("goods", (0.24, 0.2, size * 1.6), place, fruit, edge=0.02)
            else:
                geometry.ball("goods", size, place, fruit)


def fountain(thing):
    """A round basin with a bowl on a column and water that falls."""
    wide, _, tall = thing.size
    radius, stone = wide / 2, materials.plaster("stone", thing.shade, 0.002, 60.0, 0.4)
    basin = [(0, 0), (radius, 0), (radius, 0.55), (radius - 0.3, 0.55),
             (radius - 0.3, 0.2), (0, 0.2)]  # fmt: skip
    geometry.lathe("basin", basin, (0, 0, 0), stone)
    pond = paint((0.01, 0.014, 0.015), 0.05)
    geometry.cylinder("pond", radius - 0.3, 0.2, (0, 0, 0.24), pond)
    bowl = [(0, 0.2), (0.3, 0.2), (0.22, 0.6), (0.18, tall * 0.6), (0.9, tall * 0.72),
            (0.95, tall * 0.76), (0.2, tall * 0.7), (0.1, tall), (0, tall)]  # fmt: skip
    geometry.lathe("bowl", bowl, (0, 0, 0), stone)
    spray = paint((0.55, 0.6, 0.62), 0.2)
    rng = random.Random(thing.seed)
    for step in range(14):
        a = 2 * math.pi * step / 14
        c, s = math.cos(a), math.sin(a)
        points = [
            (r * c, r * s, h)
            for r, h in ((0.9, tall * 0.75), (1.25, tall * 0.62), (1.5, 0.45))
        ]
        geometry.tube("jet", points, rng.uniform(0.012, 0.022), spray)
    hue = neon_rgb(rng.random(), rng.uniform(0.0, 0.9))
    for a in (0.4, 2.5, 4.6):
        place = ((radius - 0.6) * math.cos(a), (radius - 0.6) * math.sin(a), 0.6)
        render.light("POINT", place, 45.0, color=hue, shadow_soft_size=0.1)


def church(thing):
    """A tower with a clock and a pointed roof before a nave."""
    x, y, tall = thing.size
    stone = materials.plaster("stone", thing.shade, 0.004, 25.0, 0.4)
    geometry.box(
        "tower", (5.0, 5.0, tall), (0, -y / 2 + 2.5, tall / 2), stone, edge=0.05
    )
    for z in (tall * 0.35, tall * 0.7, tall):
        geometry.box("band", (5.3, 5.3, 0.35), (0, -y / 2 + 2.5, z), stone, edge=0.05)
    roof = [(3.4, 0), (0.05, tall * 0.4), (0, tall * 0.4)]
    slate = paint((0.03, 0.05, 0.05), 0.5)
    turn = (0, 0, math.pi / 4)
    geometry.lathe("roof", roof, (0, -y / 2 + 2.5, tall), slate, turn, 4)
    geometry.box("nave", (x + 2, y, tall * 0.45), (0, 2.0, tall * 0.225), stone)
    dial = materials.glow("dial", (1.0, 0.8, 0.5), 2.0)
    flat = (math.pi / 2, 0, 0)
    geometry.cylinder("dial", 1.1, 0.1, (0, -y / 2 + 0.02, tall * 0.84), dial, flat)
    dark = paint((0.01, 0.01, 0.012))
    for turn, long in ((0.6, 0.8), (2.4, 1.0)):
        place = (0, -y / 2 - 0.12, tall * 0.84)
        geometry.box("hand", (0.08, 0.03, long), place, dark, (0, turn, 0))
    geometry.box("door", (1.8, 0.1, 3.0), (0, -y / 2 - 0.02, 1.5), dark, edge=0.02)
    for z in (tall * 0.48, tall * 0.6):
        geometry.box("slit", (0.5, 0.1, 1.6), (0, -y / 2 - 0.02, z), dark, edge=0.0)


def monument(thing):
    """A figure on a plinth."""
    x, y, tall = thing.size
    stone = materials.plaster("plinth", thing.shade, 0.002, 60.0, 0.3)
    for share, z0, z1 in ((1.0, 0.0, 0.3), (0.8, 0.3, 0.5), (0.55, 0.5, tall * 0.55)):
        size = (share * x, share * y, z1 - z0)
        geometry.box("plinth", size, (0, 0, (z0 + z1) / 2), stone, edge=0.02)
    bronze = materials.metal("bronze", (0.16, 0.20, 0.14), 0.35)
    base, rest = tall * 0.55, tall * 0.45
    body = [(0, 0), (0.34, 0), (0.26, 0.35), (0.2, 0.62), (0.3, 0.8), (0.08, 0.86),
            (0.12, 0.93), (0.05, 1.0), (0, 1.0)]  # fmt: skip
    profile = geometry.rounded([(r * rest * 0.6, h * rest) for r, h in body])
    geometry.lathe("figure", profile, (0, 0, base), bronze)
    arm = [(0.1, 0, base + rest * 0.75), (0.5, -0.2, base + rest * 1.05)]
    geometry.tube("arm", arm, 0.07, bronze)


def carousel(thing):
    """A roundabout: lit canopy, bulbs along its rim, horses as bodies on poles."""
    wide, _, tall = thing.size
    radius, hue = wide / 2, thing.shade
    cloth = paint(tuple(0.05 + 0.5 * c for c in hue), 0.5)
    deck = paint((0.3, 0.2, 0.1), 0.5)
    geometry.cylinder("deck", radius, 0.3, (0, 0, 0), deck)
    geometry.cylinder("core", 0.9, tall, (0, 0, 0), paint((0.5, 0.42, 0.25), 0.3))
    top = [(radius + 0.3, tall - 0.7), (radius + 0.3, tall - 0.2), (0, tall + 1.4),
           (0, tall - 0.2), (radius, tall - 0.7)]  # fmt: skip
    geometry.lathe("top", top, (0, 0, 0), cloth)
    warm = materials.glow("bulb", (1.0, 0.55, 0.2), 24.0)
    gold, white = (
        materials.metal("pole", (0.8, 0.6, 0.25), 0.2),
        paint((0.6, 0.55, 0.5)),
    )
    for step in range(36):
        a = 2 * math.pi * step / 36
        place = (
            (radius + 0.34) * math.cos(a),
            (radius + 0.34) * math.sin(a),
            tall - 0.4,
        )
        geometry.ball("bulb", 0.05, place, warm)
        if step % 4 == 0:
            x, y = 0.72 * radius * math.cos(a), 0.72 * radius * math.sin(a)
            rise = 1.0 + 0.25 * math.sin(3 * a)
            geometry.cylinder("pole", 0.025, tall - 0.8, (x, y, 0.3), gold)
            horse = geometry.ball("horse", 0.26, (x, y, rise), white, 0.9)
            horse.scale, horse.rotation_euler = (0.8, 1.9, 1.0), (0, 0, a)
            neck = (x - 0.38 * math.sin(a), y + 0.38 * math.cos(a))
            geometry.tube("neck", [(x, y, rise), (*neck, rise + 0.45)], 0.1, white)
    for a in (0.5, 2.6, 4.7):
        place = (0.5 * radius * math.cos(a), 0.5 * radius * math.sin(a), tall - 0.9)
        render.light("POINT", place, 70.0, color=(1.0, 0.55, 0.2), shadow_soft_size=0.2)


def lit_tree(thing):
    """A conifer with lights of several hues."""
    wide, _, tall = thing.size
    rng = random.Random(thing.seed)
    needle = paint(thing.shade, 0.6)
    geometry.cylinder("trunk", 0.18, tall * 0.3, (0, 0, 0), paint((0.06, 0.04, 0.03)))
    clump = leaves(rng, 260, 0.7, needle)
    clump.location = (0, 0, tall * 0.92)
    first, mixed = rng.random(), rng.random() < 0.6
    glows = [
        materials.glow("light", neon_rgb(first + (k / 4 if mixed else 0), 0.85), 30.0)
        for k in range(4)
    ]
    bulbs = [geometry.ball("light", 0.05, (0, 0, 0.5), glow) for glow in glows]
    for step in range(90):
        t = step / 90
        radius, z = wide / 2 * (1 - t) * 0.85, tall * (0.14 + 0.8 * t)
        a = step * 2.399
        x, y = radius * math.cos(a), radius * math.sin(a)
        geometry.copy(clump, (x, y, z), tuple(rng.uniform(0, 6.3) for _ in range(3)))
        x, y = 1.25 * x, 1.25 * y
        geometry.copy(bulbs[step % 4], (x, y, z + 0.2))
    for k, z in enumerate((tall * 0.25, tall * 0.5)):
        hue = neon_rgb(first + (k / 2 if mixed else 0), 0.7)
        place = (0, -wide / 2 - 0.3, z)
        render.light("POINT", place, 60.0, color=hue, shadow_soft_size=0.6)


def shelter(thing):
    """A bus shelter with a lit poster."""
    x, y, z = thing.size
    metal, glass = steel(), materials.pane("glass", (0.9, 0.94, 0.93))
    geometry.box("roof", (x, y, 0.08), (0, 0, z), metal)
    geometry.box(
        "back", (x - 0.1, 0.02, z - 0.5), (0, y / 2 - 0.05, z / 2 + 0.1), glass
    )
    for i in (-1, 1):
        for j in (-1, 1):
            place = (i * (x / 2 - 0.05), j * (y / 2 - 0.05), z / 2)
            geometry.box("post", (0.07, 0.07, z), place, metal)
    geometry.box("seat", (x - 0.8, 0.4, 0.06), (-0.2, y / 2 - 0.3, 0.45), metal)
    geometry.box("stand", (0.1, 0.3, 0.44), (-0.2, y / 2 - 0.3, 0.22), metal)
    hue = neon_rgb(random.Random(thing.seed).random(), 0.5)
    glow = materials.glow("poster", hue, 2.0, sampled=True)
    geometry.box("case", (0.14, 1.2, 1.9), (x / 2 - 0.1, 0, 1.15), metal)
    geometry.box("poster", (0.16, 1.05, 1.7), (x / 2 - 0.1, 0, 1.15), glow, edge=0.0)
    render.light("POINT", (0, 0, z - 0.2), 14.0, color=(1, 0.9, 0.8))


def table_set(thing):
    """A round table with a parasol and three chairs; a candle on it."""
    wood, cloth = paint((0.12, 0.07, 0.04), 0.5), paint(thing.shade, 0.7)
    geometry.cylinder("top", 0.4, 0.03, (0, 0, 0.72), wood)
    geometry.cylinder("pole", 0.02, 2.3, (0, 0, 0), steel())
    geometry.cylinder("foot", 0.25, 0.05, (0, 0, 0), steel())
    profile = [(0, 2.45), (1.15, 2.0), (1.15, 1.97), (0, 2.4)]
    geometry.lathe("parasol", profile, (0, 0, 0), cloth, segments=8)
    for a in (0.3, 2.4, 4.5):
        x, y = 0.72 * math.cos(a), 0.72 * math.sin(a)
        turn = (0, 0, a)
        geometry.box("seat", (0.42, 0.42, 0.04), (x, y, 0.45), wood, turn)
        back = (1.27 * x, 1.27 * y, 0.68)
        geometry.box("back", (0.03, 0.42, 0.42), back, wood, turn)
        for i in (-1, 1):
            for j in (-1, 1):
                place = (x + 0.17 * i, y + 0.17 * j, 0.22)
                geometry.box("leg", (0.03, 0.03, 0.44), place, wood)
    flame = materials.glow("candle", (1.0, 0.4, 0.08), 40.0)
    geometry.cylinder("candle", 0.03, 0.08, (0.12, 0, 0.75), paint((0.6, 0.58, 0.5)))
    geometry.ball("flame", 0.016, (0.12, 0, 0.86), flame, 1.8)
    render.light("POINT", (0.12, 0, 0.9), 2.2, 1900, shadow_soft_size=0.02)


THINGS = {
    "stall": stall,
    "fountain": fountain,
    "church": church,
    "monument": monument,
    "carousel": carousel,
    "lit_tree": lit_tree,
    "shelter": shelter,
    "table_set": table_set,
}
