# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Things by the water: rails, boats, bridges, cranes, a wheel. Sizes in metres."""

import math
import random

from ..choices.colour import neon_rgb
from .library import geometry, materials, paint, render, steel

WARM = (1.0, 0.62, 0.28)


def rail(thing):
    """A railing along x: posts 2 m apart and three bars."""
    long, _, tall = thing.size
    metal = steel()
    for share in (0.35, 0.68, 1.0):
        ends = [(-long / 2, 0, share * tall), (long / 2, 0, share * tall)]
        geometry.tube("bar", ends, 0.028 if share == 1.0 else 0.014, metal, soft=False)
    post = geometry.box("post", (0.06, 0.06, tall), (-long / 2, 0, tall / 2), metal)
    for step in range(1, int(long / 2) + 1):
        geometry.copy(post, (-long / 2 + 2 * step, 0, tall / 2))


def boat(thing):
    """A hull along y with a cabin, at times lit, and a mast if size[2] is above 2."""
    wide, long, mast = thing.size
    rng = random.Random(thing.seed)
    hull = paint(tuple(0.04 + 0.9 * c for c in thing.shade), 0.25, Coat_Weight=0.6)

    def surface(u, v):
        t = 2 * u - 1
        half = wide / 2 * (1 - max(0.0, -t) ** 2.5) * (0.92 if t > 0.9 else 1.0)
        a = math.pi * (v - 0.5)
        deep = 0.75 + 0.25 * abs(t) ** 3
        return half * math.sin(a), t * long / 2, 0.7 * deep - 0.9 * math.cos(a) ** 0.7

    geometry.sheet("hull", surface, 28, 18, hull)
    deck = paint((0.24, 0.15, 0.08), 0.5)
    geometry.box("deck", (wide * 0.8, long * 0.7, 0.05), (0, long * 0.08, 0.45), deck)
    white = paint((0.55, 0.54, 0.5), 0.35)
    size = (wide * 0.62, long * 0.34, 0.8)
    geometry.box("cabin", size, (0, long * 0.08, 0.85), white, edge=0.06)
    lit = rng.random() < 0.55
    pane = materials.glow("port", WARM, 0.8 if lit else 0.005)
    for side in (-1, 1):
        place = (side * size[0] / 2, long * 0.08, 0.98)
        geometry.box("port", (0.02, size[1] * 0.75, 0.28), place, pane, edge=0.0)
    place = (0, long * 0.08 - size[1] / 2, 0.98)
    geometry.box("port", (size[0] * 0.75, 0.02, 0.28), place, pane, edge=0.0)
    if mast > 2:
        metal = steel((0.4, 0.4, 0.4), 0.3)
        geometry.cylinder("mast", 0.06, mast, (0, -long * 0.12, 0.4), metal)
        boom = [(0, -long * 0.12, 1.7), (0, long * 0.32, 1.6)]
        geometry.tube("boom", boom, 0.06, paint((0.3, 0.28, 0.24)))
        for end in (-long / 2, long / 2):
            stay = [(0, -long * 0.12, mast + 0.3), (0, end * 0.95, 0.6)]
            geometry.tube("stay", stay, 0.008, metal)
        if lit:
            glow = materials.glow("top", (1.0, 0.9, 0.7), 30.0)
            geometry.ball("top", 0.08, (0, -long * 0.12, mast + 0.45), glow)


def arch(thing):
    """A canal's bridge of one arch across x, with parapets."""
    long, wide, rise = thing.size
    stone = materials.plaster("stone", thing.shade, 0.01, 12.0, 0.5)
    half, top = long / 2 + 4.0, rise + 1.6
    inner = [
        (long / 2 * math.cos(a) * 0.98, -0.2 + (rise + 0.9) * math.sin(a))
        for a in (math.pi * step / 16 for step in range(17))
    ]
    outer = [(-half, top - 0.1), (0, top + 0.6), (half, top - 0.1), (half, -0.2)]
    outline = [*inner, (-half, -0.2), *outer]
    geometry.prism("arch", outline, wide, (0, 0, 0), stone)
    parapet = [(-half, top - 0.1), (0, top + 0.6), (half, top - 0.1),
               (half, top + 0.8), (0, top + 1.5), (-half, top + 0.8)]  # fmt: skip
    for side in (-1, 1):
        geometry.prism("parapet", parapet, 0.3, (0, side * (wide / 2 - 0.15), 0), stone)
    for x in (-half + 1.5, half - 1.5):
        lantern((x, -wide / 2 + 0.15, top + 0.9), WARM, 90.0)


def lantern(place, color, power, light=True):
    """A globe on a stem, with a light."""
    x, y, z = place
    geometry.cylinder("stem", 0.05, 1.8, place, steel())
    ball = geometry.ball(
        "globe", 0.2, (x, y, z + 1.95), materials.glow("globe", color, 26)
    )
    ball.visible_shadow = ball.visible_diffuse = False
    if light:
        render.light(
            "POINT", (x, y, z + 1.95), power, color=color, shadow_soft_size=0.2
        )


def arch_bridge(thing):
    """A river's bridge of several arches along x, lanterns on its parapet."""
    long, wide, rise = thing.size
    stone = materials.plaster("stone", thing.shade, 0.01, 8.0, 0.5)
    spans = 6
    step = long / spans
    for number in range(spans):
        x = -long / 2 + (number + 0.5) * step
        inner = [
            (0.44 * step * math.cos(a), -0.3 + (rise - 1.6) * math.sin(a))
            for a in (math.pi * k / 16 for k in range(17))
        ]
        half = step / 2
        outline = [*inner, (-half, -0.3), (-half, rise), (half, rise), (half, -0.3)]
        geometry.prism("span", outline, wide, (x, 0, 0), stone)
        pier = (x - half, 0, rise / 2)
        geometry.box("pier", (1.8, wide + 1.6, rise), pier, stone, edge=0.2)
    geometry.box("parapet", (long, 0.4, 1.1), (0, -wide / 2, rise + 0.5), stone)
    geometry.box("parapet", (long, 0.4, 1.1), (0, wide / 2, rise + 0.5), stone)
    rng = random.Random(thing.seed)
    color = rng.choice((WARM, (1.0, 0.42, 0.06), (1.0, 0.85, 0.65)))
    under = neon_rgb(rng.random(), 0.9) if rng.random() < 0.5 else color
    for number in range(2 * spans):
        x = -long / 2 + (number + 0.5) * step / 2
        lantern((x, -wide / 2, rise + 1.0), color, 130.0)
        if number % 2 == 0 and abs(x) < 45:
            place = (x + step / 4, -wide / 2 - 0.5, 0.8)
            render.light("POINT", place, 120.0, color=under, shadow_soft_size=0.4)


def suspension_bridge(thing):
    """Two towers, cables with bulbs, a deck along x."""
    long, wide, rise = thing.size
    metal = steel((0.16, 0.17, 0.18), 0.4)
    rise += 3.0
    geometry.box("deck", (long, wide, 0.9), (0, 0, rise), metal, edge=0.05)
    rng = random.Random(thing.seed)
    hue = neon_rgb(rng.random(), 0.85)
    warm = rng.random() < 0.5
    bulb = materials.glow("bulb", (1.0, 0.75, 0.45) if warm else hue, 34.0)
    top, at = rise + 17.0, long * 0.2
    first = geometry.ball("bulb", 0.17, (0, 0, -60), bulb)
    for side in (-1, 1):
        y = side * wide / 2
        for x in (-at, at):
            geometry.box("tower", (1.4, 1.2, top), (x, y, top / 2), metal, edge=0.05)
            render.light(
                "SPOT", (x, y - 2.5, rise + 1), 1500.0, color=hue,
                target=(x, y, top), spot_size=0.9, shadow_soft_size=0.3,
            )  # fmt: skip
        points = []
        for step in range(61):
            x = -long / 2 + long * step / 60
            if abs(x) <= at:
                z = rise + 1.5 + (top - rise - 1.5) * (x / at) ** 2
            else:
                z = top - (top - rise) * (abs(x) - at) / (long / 2 - at)
            points.append((x, y, z))
            geometry.copy(first, (x, y, z + 0.1))
            if step % 2:
                geometry.tube("hanger", [(x, y, z), (x, y, rise)], 0.03, metal)
        geometry.tube("cable", points, 0.09, metal)
    for x in (-at, at):
        for z in (top - 0.6, rise + 7):
            geometry.box("cross", (1.0, wide, 1.0), (x, 0, z), metal)


def wheel(thing):
    """A Ferris wheel in the plane of x and z with coloured rims and cabins."""
    wide, deep, tall = thing.size
    radius = wide / 2
    hub = tall - radius
    metal = steel((0.3, 0.3, 0.3))
    rng = random.Random(thing.seed)
    second = neon_rgb(rng.random(), 0.9)
    glows = [materials.glow("rim", hue, 12.0) for hue in (thing.shade, second)]
    for number, share in enumerate((1.0, 0.72)):
        for y in (-deep / 2, deep / 2):
            circle = [
                (share * radius * math.cos(a), y, hub + share * radius * math.sin(a))
                for a in (2 * math.pi * k / 40 for k in range(41))
            ]
            geometry.tube("rim", circle, 0.07, glows[number])
    cabin = paint((0.5, 0.5, 0.5), 0.3)
    pane = materials.glow("pane", WARM, 1.6)
    for step in range(20):
        a = 2 * math.pi * step / 20 + 0.1
        x, z = radius * math.cos(a), hub + radius * math.sin(a)
        geometry.tube(
            "spoke", [(0, 0, hub), (x, 0, z)], 0.04, glows[step % 2], soft=False
        )
        geometry.box("cabin", (1.5, 1.5, 0.8), (x, 0, z - 1.5), cabin, edge=0.2)
        geometry.box("pane", (1.4, 1.4, 0.7), (x, 0, z - 0.8), pane, edge=0.1)
    for side in (-1, 1):
        for y in (-deep / 2 - 0.5, deep / 2 + 0.5):
            leg = [(side * radius * 0.5, y, 0), (0, y, hub)]
            geometry.tube("leg", leg, 0.25, metal, soft=False)
    render.light(
        "POINT", (0, -deep, hub), 2500.0, color=thing.shade, shadow_soft_size=2.0
    )


def crane(thing):
    """A portal crane with a jib towards the water and a red lamp."""
    x, y, tall = thing.size
    metal = paint((0.25, 0.12, 0.03), 0.5)
    for i in (-1, 1):
        for j in (-1, 1):
            leg = [(i * x / 2, j * y / 2, 0), (i * x / 3, j * y / 3, tall * 0.5)]
            geometry.tube("leg", leg, 0.3, metal, soft=False)
    geometry.box("platform", (x * 0.8, y * 0.8, 0.6), (0, 0, tall * 0.5), metal)
    geometry.box("cab", (2.6, 3.6, 3.0), (0, 0, tall * 0.5 + 1.8), metal, edge=0.05)
    glow = materials.glow("cab", WARM, 1.8)
    geometry.box("window", (2.0, 0.1, 1.0), (0, -1.82, tall * 0.5 + 2.2), glow, edge=0)
    geometry.tube("mast", [(0, 0, tall * 0.5), (0, 0, tall)], 0.35, metal)
    tip = (x * 0.9, -y * 1.3, tall * 1.15)
    geometry.tube("jib", [(0, 0, tall * 0.6), tip], 0.28, metal, soft=False)
    geometry.tube("rope", [(0, 0, tall), tip], 0.05, metal, soft=False)
    geometry.tube("rope", [tip, (tip[0], tip[1], 4.0)], 0.04, metal, soft=False)
    red = materials.glow("red", (1.0, 0.02, 0.01), 60.0)
    geometry.ball("red", 0.3, tip, red)
    render.light(
        "SPOT", (0, -y / 2, tall * 0.5), 1500.0, color=(1.0, 0.8, 0.55),
        target=(0, -y, 0), spot_size=1.8, shadow_soft_size=0.3,
    )  # fmt: skip


def container(thing):
    """A ribbed shipping container."""
    x, y, z = thing.size
    color = paint(tuple(0.03 + 0.8 * c for c in thing.shade), 0.5)
    geometry.box("container", (x, y, z), (0, 0, z / 2), color, edge=0.03)
    rib = geometry.box("rib", (0.12, 0.05, z - 0.3), (0, -y / 2, z / 2), color)
    for step in range(1, 12):
        geometry.copy(rib, (-x / 2 + step * x / 12, -y / 2 - 0.02, z / 2))


THINGS = {
    "rail": rail,
    "boat": boat,
    "arch": arch,
    "arch_bridge": arch_bridge,
    "suspension_bridge": suspension_bridge,
    "wheel": wheel,
    "crane": crane,
    "container": container,
}
