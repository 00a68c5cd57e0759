# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What lies on the table of the interior. Lengths in metres."""

import math
import random

import scene_geometry as geometry
import scene_materials as materials


def glassware(carafe, tumbler):
    """A carafe of amber tea and an empty tumbler, each standing on its location."""
    clear = materials.glass("clear_glass", (0.97, 0.99, 0.98))
    tea = materials.glass("tea", (0.85, 0.36, 0.06), ior=1.33)
    outer = [
        (0, 0),
        (0.048, 0),
        (0.056, 0.006),
        (0.062, 0.05),
        (0.055, 0.11),
        (0.030, 0.16),
        (0.026, 0.19),
        (0.036, 0.235),
    ]
    inner = [
        (0.0335, 0.235),
        (0.0235, 0.19),
        (0.0275, 0.16),
        (0.052, 0.11),
        (0.059, 0.05),
        (0.053, 0.010),
        (0, 0.009),
    ]
    geometry.lathe("carafe", outer + inner, carafe, clear)
    body = [(0, 0.0095), (0.0525, 0.0105), (0.0587, 0.05), (0.0535, 0.100), (0, 0.100)]
    geometry.lathe("tea", body, carafe, tea)
    cup = [
        (0, 0),
        (0.031, 0),
        (0.034, 0.003),
        (0.039, 0.095),
        (0.0378, 0.096),
        (0.0366, 0.095),
        (0.0315, 0.010),
        (0, 0.009),
    ]
    geometry.lathe("tumbler", cup, tumbler, clear)


def metalware(vase, chrome, grey):
    """A brass vase, and the chrome and 18 % grey balls of a lighting reference."""
    brass = materials.metal("brass", (0.86, 0.60, 0.24), 0.10)
    steel = materials.metal("chrome", (0.78, 0.79, 0.80), 0.015, 0.02)
    foot = [(0, 0), (0.042, 0), (0.045, 0.003), (0.045, 0.008)]
    outer = [
        (0.030, 0.03),
        (0.055, 0.09),
        (0.060, 0.125),
        (0.046, 0.18),
        (0.024, 0.215),
    ]
    outer = [*foot, *geometry.rounded([*outer, (0.034, 0.25)])]
    inner = [(0.031, 0.25), (0.021, 0.215), (0.043, 0.18), (0.056, 0.125), (0, 0.10)]
    geometry.lathe("vase", outer + inner, vase, brass)
    rest = materials.plain("ball_rest", (0.02, 0.02, 0.02), 0.6)
    for name, place, paint in (
        ("chrome", chrome, steel),
        ("grey", grey, materials.matte("grey", (0.18,) * 3)),
    ):
        x, y, z = place
        geometry.cylinder("ball_rest", 0.022, 0.012, place, rest)
        geometry.ball(name, 0.05, (x, y, z + 0.058), paint)


def fruit_bowl(location):
    """Oranges, lemons and apples in a white bowl."""
    x, y, z = location
    china = materials.plain("china", (0.78, 0.77, 0.74), 0.12, Coat_Weight=0.5)
    profile = [
        (0, 0),
        (0.055, 0),
        (0.06, 0.008),
        (0.10, 0.035),
        (0.135, 0.08),
        (0.132, 0.082),
        (0.095, 0.042),
        (0.05, 0.016),
        (0, 0.014),
    ]
    geometry.lathe("bowl", profile, location, china)
    skins = {
        "orange": (0.80, 0.20, 0.008),
        "lemon": (0.82, 0.58, 0.02),
        "apple": (0.45, 0.015, 0.012),
        "pear": (0.30, 0.50, 0.03),
    }
    fruit = (
        ("orange", -0.05, -0.045, 0.075, 0.040, 0.96),
        ("apple", 0.045, -0.055, 0.077, 0.040, 0.9),
        ("pear", 0.06, 0.04, 0.078, 0.039, 0.95),
        ("orange", -0.04, 0.05, 0.076, 0.041, 0.96),
        ("lemon", 0.005, -0.01, 0.128, 0.033, 1.15),
    )
    for name, dx, dy, dz, radius, squash in fruit:
        material, nodes = materials.begin(name)
        position = nodes.coordinates()
        pores = nodes.noise(position, 260.0, 2.0)
        tone = nodes.mix(
            nodes.remap(nodes.noise(position, 22.0), 0.35, 0.7),
            skins[name],
            [0.8 * c for c in skins[name]],
        )
        relief = 0.3 if name in ("orange", "lemon") else 0.05
        materials.finish(nodes, tone, 0.32, nodes.bump(pores, 0.0015, relief))
        geometry.ball(name, radius, (x + dx, y + dy, z + dz), material, squash)


def paper_block():
    """Return the fine ruled edge of a block of pages."""
    material, nodes = materials.begin("pages")
    lines = nodes.noise(nodes.coordinates((4, 4, 900)), 1.0, 2.0)
    tone = nodes.mix(
        nodes.remap(lines, 0.35, 0.65), (0.50, 0.44, 0.32), (0.80, 0.75, 0.62)
    )
    materials.finish(nodes, tone, 0.8)
    return material


def book(size, location, material, paper, turn=0.0):
    """A closed book lying flat: size is (spine length, depth, thickness)."""
    length, depth, thick = size
    x, y, z = location
    parts = [
        geometry.box(
            "pages",
            (length - 0.008, depth - 0.006, thick - 0.006),
            (0, 0.0, 0),
            paper,
            edge=0.0005,
        )
    ]
    for side in (-1, 1):
        parts.append(
            geometry.box(
                "cover",
                (length, depth, 0.003),
                (0, 0, side * (thick / 2 - 0.0015)),
                material,
                edge=0.001,
            )
        )
    parts.append(
        geometry.box(
            "spine", (length, 0.004, thick), (0, -depth / 2, 0), material, edge=0.0018
        )
    )
    return geometry.gather(parts, (x, y, z + thick / 2), (0, 0, turn))


def pencils(location):
    """Twelve saturated pencils in a steel cup."""
    x, y, z = location
    rng = random.Random(7)
    steel = materials.metal("cup", (0.6, 0.6, 0.62), 0.25)
    profile = [
        (0, 0),
        (0.038, 0),
        (0.04, 0.002),
        (0.04, 0.095),
        (0.0385, 0.095),
        (0.0385, 0.004),
        (0, 0.004),
    ]
    geometry.lathe("cup", profile, location, steel)
    hues = (
        (0.7, 0.01, 0.01),
        (0.8, 0.35, 0.0),
        (0.85, 0.7, 0.01),
        (0.02, 0.4, 0.03),
        (0.005, 0.35, 0.5),
        (0.01, 0.02, 0.5),
        (0.3, 0.01, 0.4),
        (0.8, 0.08, 0.3),
    )
    tip = materials.wood("pencil_tip", (0.45, 0.28, 0.14), (0.62, 0.43, 0.25))
    for index in range(12):
        angle = 2 * math.pi * index / 12 + rng.uniform(-0.2, 0.2)
        tilt, turn = rng.uniform(0.06, 0.17), angle
        paint = materials.plain("pencil", hues[index % 8], 0.25)
        length = rng.uniform(0.13, 0.18)
        shaft = [(0, 0), (0.0037, 0), (0.0037, length), (0, length)]
        head = [(0.0037, length), (0.0010, length + 0.016), (0, length + 0.016)]
        base = (x + 0.022 * math.cos(angle), y + 0.022 * math.sin(angle), z + 0.006)
        spin = (0, tilt, turn)
        geometry.lathe("pencil", shaft, base, paint, spin, 6)
        geometry.lathe("pencil_tip", head, base, tip, spin, 12)


def plant(location):
    """Arching leaves in a terracotta pot."""
    x, y, z = location
    clay = materials.plaster("terracotta", (0.46, 0.15, 0.07), 0.001, 140.0, 0.3)
    leaf = materials.plain("leaf", (0.035, 0.17, 0.02), 0.35, Coat_Weight=0.3)
    pot = [
        (0, 0),
        (0.062, 0),
        (0.085, 0.13),
        (0.094, 0.13),
        (0.096, 0.16),
        (0.086, 0.16),
        (0.082, 0.14),
        (0, 0.14),
    ]
    geometry.lathe("pot", pot, location, clay)
    rng = random.Random(5)
    for index in range(34):
        turn, rise = index * 2.399, rng.uniform(0.25, 0.52)
        reach, width = rng.uniform(0.12, 0.30), rng.uniform(0.018, 0.030)
        droop = rng.uniform(0.05, 0.28)

        def surface(u, v, rise=rise, reach=reach, width=width, droop=droop):
            half = width * math.sin(math.pi * min(1.0, 0.08 + 0.92 * v)) * (2 * u - 1)
            return (reach * v**1.4, half, rise * v - droop * v**3 + abs(half) * 0.5)

        geometry.sheet("leaf", surface, 6, 18, leaf, (x, y, z + 0.13), (0, 0, turn))
