# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tungsten lamps of the interior. Lengths in metres."""

import math

import scene_geometry as geometry
import scene_materials as materials
from scene_render import light


def table_lamp(location):
    """A cobalt glazed lamp with a linen shade, lit at 2700 K."""
    glaze = materials.plain("cobalt_glaze", (0.012, 0.045, 0.36), 0.08, Coat_Weight=1.0)
    brass = materials.metal("lamp_brass", (0.80, 0.55, 0.22), 0.18)
    linen = materials.weave(
        "shade_linen", (0.85, 0.74, 0.56), (0.66, 0.54, 0.37), 0.006, translucent=0.38
    )
    x, y, z = location
    foot = [(0, 0), (0.075, 0), (0.078, 0.004), (0.078, 0.010)]
    body = [(0.060, 0.022), (0.085, 0.06), (0.098, 0.105), (0.088, 0.15), (0.055, 0.19)]
    neck = [(0.03, 0.215), (0.028, 0.235)]
    profile = [*foot, *geometry.rounded(body + neck), (0, 0.235)]
    geometry.lathe("lamp_base", profile, location, glaze)
    geometry.cylinder("lamp_stem", 0.008, 0.16, (x, y, z + 0.23), brass)
    shade = [(0.165, 0.29), (0.095, 0.51), (0.0935, 0.51), (0.1635, 0.29)]
    geometry.lathe("lamp_shade", shade + shade[:1], location, linen)
    bulb = geometry.ball(
        "lamp_bulb",
        0.03,
        (x, y, z + 0.40),
        materials.glow_kelvin("lamp_bulb", 2700, 90.0),
    )
    bulb.visible_shadow = False
    light("POINT", (x, y, z + 0.40), 13.0, 2700, shadow_soft_size=0.028)


def filament_bulb(location, drop):
    """A clear bulb with a visible 2400 K filament on a cord of length @p drop."""
    x, y, z = location
    brass = materials.metal("socket_brass", (0.75, 0.50, 0.20), 0.22)
    cord = materials.plain("cord", (0.02, 0.02, 0.022), 0.8)
    profile = [
        (0.013, 0.0),
        (0.016, -0.02),
        (0.034, -0.06),
        (0.041, -0.09),
        (0.036, -0.12),
        (0.018, -0.137),
        (0, -0.141),
    ]
    geometry.lathe(
        "globe", profile, location, materials.pane("globe", (0.99, 0.97, 0.92))
    )
    geometry.cylinder("socket", 0.021, 0.06, (x, y, z - 0.006), brass, edge=0.005)
    geometry.tube("cord", [(x, y, z + 0.05), (x, y, z + drop)], 0.003, cord)
    wire = materials.glow_kelvin("filament", 2400, 1500.0)
    for step in range(6):
        angle = math.pi * step / 3
        c, s = math.cos(angle), math.sin(angle)
        points = [
            (x + r * c, y + r * s, z - h)
            for r, h in ((0.006, 0.035), (0.019, 0.075), (0.009, 0.115))
        ]
        geometry.tube("filament", points, 0.0011, wire).visible_shadow = False
    light("POINT", (x, y, z - 0.075), 3.0, 2400, shadow_soft_size=0.02)
