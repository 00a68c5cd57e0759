# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Small things of streets: trees, benches, bins. Sizes (x, y, z) in metres."""

import math
import random

from .library import geometry, materials, paint, steel


def bin_(thing):
    """A round litter bin."""
    _, _, tall = thing.size
    geometry.cylinder("bin", 0.26, tall * 0.85, (0, 0, 0), steel((0.03, 0.05, 0.04)))
    geometry.cylinder("lid", 0.28, 0.06, (0, 0, tall * 0.88), steel())
    geometry.cylinder("stem", 0.03, 0.1, (0, 0, tall * 0.82), steel())


def bollard(thing):
    """A cast iron post with a white band."""
    iron = steel((0.02, 0.02, 0.022))
    profile = [(0, 0), (0.09, 0), (0.09, 0.05), (0.06, 0.09), (0.055, 0.8),
               (0.075, 0.83), (0.075, 0.87), (0.05, 0.93), (0, 0.95)]  # fmt: skip
    geometry.lathe("bollard", profile, (0, 0, 0), iron, segments=24)
    geometry.cylinder("band", 0.061, 0.09, (0, 0, 0.62), paint((0.7, 0.7, 0.68)))


def box(thing):
    """A crate or a carton."""
    x, y, z = thing.size
    color = tuple(0.06 + 0.3 * c for c in thing.shade)
    geometry.box("box", (x, y, z), (0, 0, z / 2), paint(color, 0.7), edge=0.01)
    small = (0.7 * x, 0.8 * y, 0.6 * z)
    geometry.box("box", small, (0.02, 0, 1.3 * z), paint((0.2, 0.13, 0.07), 0.8))


def bicycle(thing):
    """A bicycle on its stand, along y."""
    metal, rubber = paint(thing.shade, 0.3, Metallic=0.4), paint((0.012,) * 3, 0.6)
    for y in (-0.52, 0.52):
        circle = [
            (0, y + 0.33 * math.cos(a), 0.34 + 0.33 * math.sin(a))
            for a in (2 * math.pi * step / 20 for step in range(21))
        ]
        geometry.tube("tyre", circle, 0.018, rubber)
        geometry.cylinder(
            "hub", 0.03, 0.1, (-0.05, y, 0.34), metal, (0, math.pi / 2, 0)
        )
    crank, saddle, head = (0, 0.1, 0.3), (0, 0.22, 0.82), (0, -0.34, 0.80)
    rear, fork = (0, 0.52, 0.34), (0, -0.52, 0.34)
    for pair in (
        (crank, saddle), (crank, head), (saddle, head), (rear, crank), (rear, saddle),
        (head, fork), (head, (0, -0.3, 1.0)),
    ):  # fmt: skip
        geometry.tube("frame", list(pair), 0.016, metal, soft=False)
    geometry.tube("bar", [(-0.28, -0.2, 1.0), (0.28, -0.2, 1.0)], 0.014, rubber)
    geometry.tube("bar", [(0, -0.3, 1.0), (0, -0.2, 1.0)], 0.014, rubber)
    geometry.box("saddle", (0.14, 0.26, 0.06), (0, 0.24, 0.87), rubber, edge=0.02)


def bench(thing):
    """A wooden bench with a back, facing -y."""
    x, y, _ = thing.size
    wood, iron = paint(thing.shade, 0.5), steel()
    for step in range(4):
        place = (0, -y / 2 + 0.08 + 0.12 * step, 0.45)
        geometry.box("slat", (x, 0.1, 0.035), place, wood)
    for z in (0.62, 0.78):
        geometry.box("slat", (x, 0.03, 0.11), (0, y / 2 - 0.02, z), wood)
    for side in (-1, 1):
        at = side * (x / 2 - 0.2)
        geometry.box("leg", (0.05, y - 0.1, 0.43), (at, 0, 0.215), iron, edge=0.01)
        geometry.box("stay", (0.05, 0.04, 0.5), (at, y / 2 + 0.01, 0.6), iron)


def leaves(rng, count, radius, material):
    """Return a ball of @count leaves as small quadrilaterals."""
    vertices, faces = [], []
    for _ in range(count):
        centre = [rng.gauss(0, 0.42) * radius for _ in range(3)]
        a = [rng.uniform(-1, 1) for _ in range(3)]
        b = [rng.uniform(-1, 1) for _ in range(3)]
        start = len(vertices)
        for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            vertices.append(
                tuple(centre[k] + 0.07 * (s * a[k] + t * b[k]) for k in range(3))
            )
        faces.append((start, start + 1, start + 2, start + 3))
    data = geometry.mesh("leaves", vertices, faces)
    return geometry.place("leaves", data, material)


def tree(thing):
    """A tree of thing.size[2] metres: trunk, boughs, clumps of leaves."""
    rng, tall = random.Random(thing.seed), thing.size[2]
    bark = materials.plaster("bark", (0.09, 0.065, 0.045), 0.02, 30.0, 0.5)
    crown = tall * 0.34
    trunk = tall * 0.42
    profile = [(0, -0.05), (0.2, -0.05), (0.14, 0.5), (0.10, trunk), (0.04, tall * 0.8)]
    geometry.lathe("trunk", [*profile, (0, tall * 0.8)], (0, 0, 0), bark, segments=12)
    leaf = paint(tuple(c * rng.uniform(0.8, 1.3) for c in thing.shade), 0.6)
    clump = leaves(rng, 420, crown * 0.42, leaf)
    clump.location = (0, 0, tall - crown * 0.5)
    for _ in range(22):
        a, up = rng.uniform(0, 2 * math.pi), rng.uniform(-0.8, 0.9)
        out = crown * 0.85 * math.sqrt(1 - up * up) * rng.uniform(0.6, 1.0)
        place = (out * math.cos(a), out * math.sin(a), tall - crown * (0.9 - 0.8 * up))
        turn = tuple(rng.uniform(0, 6.3) for _ in range(3))
        geometry.copy(clump, place, turn)
        if rng.random() < 0.35:
            start = (0, 0, trunk * rng.uniform(0.85, 1.3))
            geometry.tube("bough", [start, place], 0.035, bark)


def canopy(thing):
    """A petrol station's roof on columns, with pumps under it."""
    x, y, z = thing.size
    white, band = paint((0.6, 0.6, 0.58), 0.4), paint(thing.shade, 0.4)
    geometry.box("roof", (x, y, 0.12), (0, 0, z), white)
    glow = materials.glow("fascia", thing.shade, 3.0)
    for side in (-1, 1):
        geometry.box("fascia", (0.1, y, 0.6), (side * x / 2, 0, z + 0.2), glow)
        geometry.box("fascia", (x, 0.1, 0.6), (0, side * y / 2, z + 0.2), glow)
    screen = materials.glow("price", (0.9, 0.95, 1.0), 2.5)
    for at in (-y / 4, y / 4):
        geometry.box("column", (0.35, 0.35, z), (0, at, z / 2), white)
        for aside in (-0.85, 0.85):
            geometry.box("island", (1.0, 0.6, 0.15), (aside, at, 0.2), white, edge=0.03)
            geometry.box("pump", (0.75, 0.45, 1.7), (aside, at, 1.0), band, edge=0.04)
            for face in (-1, 1):
                place = (aside, at + face * 0.235, 1.45)
                geometry.box("price", (0.45, 0.01, 0.25), place, screen, edge=0.0)


THINGS = {
    "bin": bin_,
    "bollard": bollard,
    "box": box,
    "bicycle": bicycle,
    "bench": bench,
    "tree": tree,
    "canopy": canopy,
}
