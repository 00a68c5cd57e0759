# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Things that stand in the night street: cars, lamps, neon. Lengths in metres."""

import math
from itertools import pairwise

import scene_geometry as geometry
import scene_materials as materials
from scene_render import degrees, light

SODIUM = (1.0, 0.42, 0.06)  # linear Rec.709, the orange of a high pressure lamp
LED = (0.80, 0.93, 1.0)
CAR_LENGTH = 4.4
# Height of the car's silhouette in metres along its length, 0 front to 1 rear.
SILHOUETTE = (
    (0.0, 0.25),
    (0.004, 0.50),
    (0.015, 0.66),
    (0.06, 0.77),
    (0.26, 0.93),
    (0.30, 0.98),
    (0.43, 1.38),
    (0.52, 1.45),
    (0.68, 1.43),
    (0.78, 1.33),
    (0.90, 1.02),
    (0.97, 0.96),
    (0.99, 0.86),
    (0.997, 0.60),
    (1.0, 0.25),
)


def silhouette(t):
    """Return the height of the body in metres at @p t of its length, 0..1."""
    for (t0, h0), (t1, h1) in pairwise(SILHOUETTE):
        if t <= t1:
            return h0 + (h1 - h0) * (t - t0) / (t1 - t0)
    return SILHOUETTE[-1][1]


def body_point(t, v):
    """Return the body surface at @p t along the length and @p v around, 0..1."""
    floor, height = 0.24, silhouette(t)
    end = abs(2 * t - 1)
    half = 0.89 * (1 - 0.13 * end**5)
    cosine, sine = math.cos(math.pi * v), math.sin(math.pi * v)
    z = floor + (height - floor) * max(sine, 0.0) ** 0.55
    narrow = 1 - 0.30 * max(0.0, (z - 0.88) / 0.57) - 0.05 * max(0.0, (0.5 - z) / 0.26)
    x = -math.copysign(abs(cosine) ** 0.30, cosine) * half * narrow
    bow = 0.10 * (1 - (x / 0.89) ** 2)
    y = (t - 0.5) * CAR_LENGTH + (bow if t > 0.5 else -bow) * end**6
    return x, y, z


def car_body(paint, window):
    """Return the shell with glazed sides and screens; its front points to -y."""
    shell = geometry.sheet("car", lambda u, v: body_point(u, v), 240, 96, paint)
    shell.data.materials.append(window)
    for face in shell.data.polygons:
        t = face.center.y / CAR_LENGTH + 0.5
        pillar = abs(face.center.x) > 0.45 and (abs(t - 0.565) < 0.012 or t > 0.82)
        side = abs(face.center.x) > 0.62
        roof = silhouette(t) - (0.10 if side else -1.0)
        if 0.93 < face.center.z < min(1.37, roof) and 0.29 < t < 0.90 and not pillar:
            face.material_index = 1
    return shell


def wheels():
    """Return four tyres with five spokes each, in black arches."""
    rubber = materials.plain("rubber", (0.015, 0.015, 0.016), 0.6)
    alloy = materials.metal("alloy", (0.45, 0.46, 0.48), 0.25)
    parts = []
    for side in (-1, 1):
        for y in (-1.36, 1.36):
            turn = (0, math.copysign(math.pi / 2, side), 0)
            for radius, start, end in ((0.385, 0.60, 0.876), (0.33, 0.69, 0.90)):
                parts.append(
                    geometry.cylinder(
                        "tyre",
                        radius,
                        end - start,
                        (side * start, y, 0.33),
                        rubber,
                        turn,
                        0.03,
                    )
                )
            parts.append(
                geometry.lathe(
                    "rim",
                    [(0.205, 0), (0.225, 0), (0.225, 0.01), (0.205, 0.01), (0.205, 0)],
                    (side * 0.897, y, 0.33),
                    alloy,
                    turn,
                )
            )
            for spoke in range(5):
                angle = 2 * math.pi * spoke / 5 + 0.4 * y
                hub = (
                    side * 0.897,
                    y + 0.105 * math.cos(angle),
                    0.33 + 0.105 * math.sin(angle),
                )
                parts.append(
                    geometry.box(
                        "spoke", (0.016, 0.21, 0.042), hub, alloy, (angle, 0, 0), 0.006
                    )
                )
    return parts


def car(location, turn, color, head, tail):
    """A car facing -y before its @p turn; lamp radiances in scene units, 0 is off."""
    paint = materials.plain(
        "car_paint", color, 0.28, Metallic=0.35, Coat_Weight=1.0, Coat_Roughness=0.03
    )
    window = materials.plain("car_window", (0.006, 0.007, 0.008), 0.03)
    parts = [car_body(paint, window), *wheels()]
    white = materials.glow("head_lamp", (1.0, 0.95, 0.84), max(head, 0.01))
    red = materials.glow("tail_lamp", (1.0, 0.018, 0.006), max(tail, 0.02))
    plate = materials.glow("plate", (0.9, 0.85, 0.6), 0.15 if tail else 0.002)
    rear, front = CAR_LENGTH / 2, -CAR_LENGTH / 2
    for side in (-1, 1):
        parts.append(
            geometry.box(
                "head",
                (0.30, 0.10, 0.11),
                (side * 0.56, front + 0.03, 0.63),
                white,
                edge=0.04,
            )
        )
        parts.append(
            geometry.box(
                "tail",
                (0.32, 0.08, 0.12),
                (side * 0.54, rear - 0.005, 0.80),
                red,
                edge=0.03,
            )
        )
        if head:
            lamp = light(
                "SPOT",
                (side * 0.6, front - 0.12, 0.63),
                260.0,
                color=(1.0, 0.95, 0.84),
                target=(side * 0.7, front - 14, -0.2),
                spot_size=1.1,
                spot_blend=0.8,
                shadow_soft_size=0.06,
            )
            parts.append(lamp)
        if tail:
            parts.append(
                light(
                    "POINT",
                    (side * 0.54, rear + 0.12, 0.8),
                    5.0,
                    color=(1.0, 0.018, 0.006),
                    shadow_soft_size=0.06,
                )
            )
    parts.append(
        geometry.box("plate", (0.50, 0.02, 0.11), (0, rear + 0.10, 0.60), plate)
    )
    return geometry.gather(parts, location, (0, 0, turn))


def street_lamp(location, side, color, power):
    """A 7 m pole whose arm reaches over the road; side is the sign of its x."""
    x, y, _ = location
    steel = materials.plain("pole", (0.035, 0.038, 0.04), 0.35, Metallic=0.8)
    geometry.cylinder("pole", 0.055, 6.6, location, steel)
    geometry.cylinder("pole_foot", 0.10, 0.9, location, steel, edge=0.03)
    reach = x - side * 1.5
    geometry.tube(
        "arm", [(x, y, 6.3), (x - side * 0.25, y, 6.85), (reach, y, 7.0)], 0.035, steel
    )
    geometry.box("lamp_head", (0.75, 0.26, 0.10), (reach, y, 7.0), steel, edge=0.03)
    lens = geometry.box(
        "lens",
        (0.5, 0.2, 0.03),
        (reach, y, 6.935),
        materials.glow("lens", color, 130.0),
        edge=0.01,
    )
    lens.visible_glossy = lens.visible_diffuse = lens.visible_shadow = False
    light(
        "SPOT",
        (reach, y, 6.88),
        power,
        color=color,
        target=(reach, y, 0),
        spot_size=2.75,
        spot_blend=0.5,
        shadow_soft_size=0.12,
    )


def neon(text, size, color, strength, location, rotation, board=None, wide=0.011):
    """Neon lettering; a board (width, height) carries it, facing like the letters."""
    tubes = materials.glow("neon", color, strength, sampled=True)
    letters = geometry.lettering(
        "neon", text, size, wide, tubes, (0, 0, 0.05), (0, 0, 0)
    )
    parts = [letters]
    if board is not None:
        black = materials.plain("sign_board", (0.015, 0.015, 0.018), 0.2)
        parts.append(
            geometry.box("sign_board", (*board, 0.06), (0, 0, -0.02), black, edge=0.012)
        )
    geometry.gather(parts, location, rotation)


def neon_ring(radius, color, strength, location, rotation):
    """Two concentric neon circles."""
    tubes = materials.glow("neon_ring", color, strength, sampled=True)
    rings = []
    for scale in (1.0, 0.82):
        points = [
            (scale * radius * math.cos(a), scale * radius * math.sin(a), 0.05)
            for a in [2 * math.pi * step / 24 for step in range(25)]
        ]
        rings.append(geometry.tube("ring", points, 0.013, tubes))
    geometry.gather(rings, location, rotation)


def traffic_light(location):
    """A signal at red towards -y."""
    x, y, z = location
    black = materials.plain("signal_case", (0.012, 0.013, 0.013), 0.4)
    geometry.cylinder("signal_pole", 0.06, 3.0, location, black)
    geometry.box("signal", (0.30, 0.22, 0.92), (x, y, z + 3.0), black, edge=0.03)
    lenses = (
        (0.29, (1.0, 0.015, 0.008), 45.0),
        (0.0, (0.5, 0.25, 0.01), 0.012),
        (-0.29, (0.01, 0.4, 0.15), 0.012),
    )
    for rise, color, strength in lenses:
        paint = materials.glow("signal_lens", color, strength, sampled=strength > 1)
        geometry.cylinder(
            "signal_lens",
            0.10,
            0.02,
            (x, y - 0.10, z + 3.0 + rise),
            paint,
            degrees(90, 0, 0),
            0.008,
        )
        hood = [(0.12, 0), (0.125, 0.0), (0.125, 0.16), (0.12, 0.16), (0.12, 0)]
        geometry.lathe(
            "signal_hood", hood, (x, y - 0.10, z + 3.0 + rise), black, degrees(90, 0, 0)
        )


def festoon(start, end, sag, count):
    """A string of warm bulbs hung between two points."""
    cable = materials.plain("cable", (0.01, 0.01, 0.01), 0.6)
    bulb = materials.glow_kelvin("festoon", 2500, 30.0)
    points = []
    for step in range(count + 1):
        t = step / count
        drop = 4 * sag * t * (1 - t)
        points.append(
            [
                a + (b - a) * t - (drop if axis == 2 else 0.0)
                for axis, (a, b) in enumerate(zip(start, end, strict=True))
            ]
        )
    geometry.tube("cable", points, 0.008, cable)
    for x, y, z in points[1:-1]:
        geometry.ball("festoon_bulb", 0.045, (x, y, z - 0.07), bulb, 1.25)
        light("POINT", (x, y, z - 0.16), 2.2, 2500, shadow_soft_size=0.04)


def bollard(location):
    """A cast iron post with a white band."""
    x, y, z = location
    iron = materials.plain("iron", (0.02, 0.02, 0.022), 0.3)
    band = materials.plain("band", (0.7, 0.7, 0.68), 0.3)
    profile = [
        (0, 0),
        (0.09, 0),
        (0.09, 0.05),
        (0.06, 0.09),
        (0.055, 0.8),
        (0.075, 0.83),
        (0.075, 0.87),
        (0.05, 0.93),
        (0, 0.95),
    ]
    geometry.lathe("bollard", profile, location, iron)
    geometry.cylinder("band", 0.061, 0.09, (x, y, z + 0.62), band)
