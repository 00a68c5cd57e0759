# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Lamps: a body, a glowing lens and a light. Metres; power in W of Blender.

Each is built at the origin, reaching or shining to -y, and then moved."""

import math

from ..choices.colour import lamp_rgb
from .library import geometry, group, materials, render, steel

LENS = 90.0  # radiance of a street lamp's lens; indoors less


def lens(shape, color, strength, size, place):
    """Return a glowing box or ball that lights nothing by itself."""
    glow = materials.glow("lens", color, strength)
    if shape == "ball":
        item = geometry.ball("lens", size, place, glow)
    else:
        item = geometry.box("lens", size, place, glow, edge=0.0)
    item.visible_glossy = item.visible_diffuse = item.visible_shadow = False
    return item


def bulb_light(place, power, color, radius=0.08):
    """Add a point light."""
    render.light("POINT", place, power, color=color, shadow_soft_size=radius)


def spot(place, power, color, target, angle=2.7):
    """Add a spot light with a soft rim."""
    render.light(
        "SPOT",
        place,
        power,
        color=color,
        target=target,
        spot_size=angle,
        spot_blend=0.5,
        shadow_soft_size=0.12,
    )


def pole(lamp, color):
    """A 7 m pole with an arm over the road."""
    metal = steel()
    geometry.cylinder("pole", 0.055, 6.6, (0, 0, 0), metal)
    geometry.cylinder("pole_foot", 0.10, 0.9, (0, 0, 0), metal, edge=0.03)
    geometry.tube("arm", [(0, 0, 6.3), (0, -0.25, 6.85), (0, -1.5, 7.0)], 0.035, metal)
    geometry.box("head", (0.26, 0.75, 0.10), (0, -1.5, 7.0), metal, edge=0.03)
    lens("box", color, LENS, (0.2, 0.5, 0.03), (0, -1.5, 6.935))
    spot((0, -1.5, 6.88), lamp.power, color, (0, -1.5, 0))


def post(lamp, color):
    """A low post with a globe or a lantern, as squares and quays have them."""
    metal, tall = steel(), 3.6 * lamp.size
    profile = [(0, 0), (0.14, 0), (0.14, 0.1), (0.07, 0.3), (0.05, tall), (0, tall)]
    geometry.lathe("post", profile, (0, 0, 0), metal, segments=16)
    lens("ball", color, LENS / 3, 0.17 * lamp.size, (0, 0, tall + 0.15))
    cap = [(0, 0.22), (0.24, 0.14), (0.25, 0.13), (0, 0.16)]
    geometry.lathe("cap", cap, (0, 0, tall + 0.1 * lamp.size), metal, segments=24)
    bulb_light((0, 0, tall - 0.06), lamp.power, color, 0.16)


def bracket(lamp, color):
    """A lantern on a bracket of a wall."""
    metal = steel()
    geometry.tube("arm", [(0, 0, 0), (0, -0.35, 0.16), (0, -0.6, 0.1)], 0.018, metal)
    shade = [(0.02, 0.12), (0.19, 0.0), (0.2, 0.0), (0.03, 0.14)]
    geometry.lathe("shade", shade, (0, -0.6, -0.05), metal, segments=24)
    lens("ball", color, LENS / 3, 0.06, (0, -0.6, -0.03))
    spot((0, -0.6, -0.1), lamp.power * 1.6, color, (0, -0.8, -4), 2.9)


def bulb(lamp, color):
    """A bare bulb that hangs in a stall."""
    lens("ball", color, 40.0, 0.05, (0, 0, 0))
    bulb_light((0, 0, -0.08), lamp.power, color, 0.05)


def flood(lamp, color):
    """A flood light on the ground that shines up and to +y."""
    geometry.box("flood", (0.5, 0.25, 0.35), (0, 0, 0), steel(), edge=0.02)
    spot((0, 0.2, 0.2), lamp.power, color, (0, 7.0, 9.0), 1.5)


def pendant(lamp, color):
    """A shade on a cord, some 0.9 m below the ceiling."""
    drop = 0.9
    geometry.cylinder("cord", 0.004, drop, (0, 0, -drop), steel())
    shade = [(0.02, 0.14), (0.17, 0.0), (0.175, 0.0), (0.03, 0.16)]
    geometry.lathe("shade", shade, (0, 0, -drop), steel((0.05, 0.05, 0.05)))
    lens("ball", color, 30.0, 0.05, (0, 0, -drop + 0.05))
    bulb_light((0, 0, -drop - 0.03), lamp.power, color, 0.06)


def area(lamp, color, width, length):
    """A glowing ceiling panel and its area light, shining down."""
    radiance = lamp.power / (math.pi * width * length)
    lens("box", color, min(14.0, radiance), (width, length, 0.02), (0, 0, -0.06))
    render.light(
        "AREA",
        (0, 0, -0.09),
        lamp.power,
        color=color,
        target=(0, 0, -3),
        shape="RECTANGLE",
        size=width,
        size_y=length,
    )


def panel(lamp, color):
    """A square ceiling panel."""
    area(lamp, color, 0.6, 0.6)


def tube(lamp, color):
    """A long fluorescent tube across the room in a tray."""
    geometry.box("tray", (1.6, 0.2, 0.05), (0, 0, -0.02), steel((0.3, 0.3, 0.3)))
    area(lamp, color, 1.5, 0.08)


LAMPS = {
    "pole": pole,
    "post": post,
    "bracket": bracket,
    "bulb": bulb,
    "flood": flood,
    "pendant": pendant,
    "panel": panel,
    "tube": tube,
}


def build(lamps):
    """Build all lamps of a scene."""
    for lamp in lamps:
        with group(lamp.place, lamp.turn):
            LAMPS[lamp.name](lamp, lamp_rgb(lamp.kelvin, lamp.duv))


def festoons(strings):
    """Hang strings of bulbs; every third bulb has a light, which stands for three."""
    for each in strings:
        points = []
        for step in range(each.count + 1):
            t = step / each.count
            straight = [
                a + (b - a) * t for a, b in zip(each.start, each.end, strict=True)
            ]
            straight[2] -= 4 * each.sag * t * (1 - t)
            points.append(straight)
        geometry.tube("cable", points, 0.008, steel())
        bulbs = [
            geometry.ball("bulb", 0.045, (0, 0, -50), materials.glow("bulb", hue, 26.0))
            for hue in each.colours
        ]
        for step, (x, y, z) in enumerate(points[1:-1]):
            number = step % len(bulbs)
            geometry.copy(bulbs[number], (x, y, z - 0.07))
            if step % 3 == 1:
                hue = each.colours[number]
                bulb_light((x, y, z - 0.16), 6.0, hue, 0.05)
