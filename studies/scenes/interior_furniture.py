# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Table, bookcase, picture, stool and rug of the interior. Lengths in metres."""

import random

import scene_geometry as geometry
import scene_materials as materials
from interior_room import BACK

TABLE_TOP = 0.75  # height


def furniture():
    """The table, a shelf of books in the dark corner, a stool, a rug, a picture."""
    walnut = materials.wood("walnut", (0.075, 0.032, 0.014), (0.24, 0.125, 0.06), 0.28)
    legs = materials.wood(
        "walnut_legs", (0.06, 0.026, 0.012), (0.18, 0.09, 0.042), 0.35, "z"
    )
    low, high = (-1.18, 1.78, TABLE_TOP - 0.035), (0.78, 2.62, TABLE_TOP)
    geometry.span("table_top", low, high, walnut, edge=0.006)
    geometry.span("apron", (-1.08, 1.86, 0.63), (0.68, 1.885, 0.715), walnut)
    for x in (-1.08, 0.68):
        for y in (1.88, 2.52):
            geometry.span(
                "leg", (x - 0.03, y - 0.03, 0), (x + 0.03, y + 0.03, 0.72), legs
            )
    rug = materials.weave("rug", (0.36, 0.05, 0.03), (0.55, 0.42, 0.26), 0.016, 0.11)
    geometry.box("rug", (2.0, 1.5, 0.012), (-0.4, 1.62, 0.006), rug, edge=0.005)
    bookcase(0.80, 1.62)
    picture((-0.55, BACK - 0.012, 1.66))
    stool((-0.62, 1.28))


def bookcase(x0, x1):
    """An open case against the back wall, filled with books, little light inside."""
    dark = materials.wood(
        "dark_oak", (0.03, 0.014, 0.007), (0.085, 0.04, 0.018), 0.4, "z"
    )
    y0, y1, top = BACK - 0.28, BACK - 0.005, 1.92
    geometry.span("case_back", (x0, y1 - 0.01, 0), (x1, y1, top), dark)
    for x in (x0, x1 - 0.022):
        geometry.span("case_side", (x, y0, 0), (x + 0.022, y1, top), dark)
    rng = random.Random(11)
    for level in range(7):
        z = 0.06 + level * 0.308
        low, high = (x0 + 0.02, y0 + 0.002, z - 0.02), (x1 - 0.02, y1 - 0.002, z)
        geometry.span("case_shelf", low, high, dark)
        if z + 0.3 < top + 0.05:
            row_of_books(rng, x0 + 0.03, x1 - 0.1, y0 + 0.03, z)


def row_of_books(rng, x, end, y, z):
    """Stand random books with their spines at @p y from @p x to @p end."""
    hues = (
        (0.30, 0.02, 0.02),
        (0.02, 0.05, 0.22),
        (0.03, 0.14, 0.06),
        (0.5, 0.3, 0.04),
        (0.55, 0.5, 0.4),
        (0.02, 0.02, 0.025),
        (0.30, 0.09, 0.02),
        (0.05, 0.2, 0.25),
    )
    gold = materials.metal("gilding", (0.8, 0.55, 0.2), 0.25)
    while x < end:
        thick, tall = rng.uniform(0.016, 0.05), rng.uniform(0.19, 0.265)
        back = y + rng.uniform(0, 0.025)
        cloth = materials.plaster("binding", rng.choice(hues), 0.0006, 700.0)
        geometry.span("book", (x, back, z), (x + thick, back + 0.17, z + tall), cloth)
        if rng.random() < 0.5:
            for share in (0.18, 0.8):
                band = z + share * tall
                geometry.span(
                    "band",
                    (x - 2e-4, back - 3e-4, band),
                    (x + thick + 2e-4, back + 0.01, band + 0.006),
                    gold,
                    edge=0,
                )
        x += thick + rng.choice((0.001, 0.001, 0.002, 0.03))


def picture(location):
    """A framed abstract print: saturated fields on a white mount."""
    material, nodes = materials.begin("print")
    position = nodes.coordinates((3.4, 1.0, 4.6))
    warped = nodes.add("VectorMath", {0: position}, operation="ADD")
    nodes.plug(
        warped.inputs[1],
        nodes.add("TexNoise", {"Vector": position, "Scale": 1.4}).outputs["Color"],
    )
    cells = nodes.add(
        "TexVoronoi", {"Vector": warped.outputs[0], "Scale": 1.5, "Randomness": 1.0}
    ).outputs["Color"]
    hue = nodes.add("SeparateColor", {0: cells}).outputs[0]
    stops = [
        (0.0, (0.02, 0.07, 0.35)),
        (0.2, (0.75, 0.28, 0.02)),
        (0.4, (0.6, 0.03, 0.05)),
        (0.6, (0.02, 0.28, 0.24)),
        (0.8, (0.8, 0.62, 0.12)),
        (1.0, (0.65, 0.6, 0.5)),
    ]
    color = nodes.ramp(hue, stops)
    grain = nodes.noise(nodes.coordinates(), 420.0, 3.0)
    color = nodes.mix(nodes.remap(grain, 0.45, 0.7, 0.0, 0.25), color, (0.8, 0.78, 0.7))
    materials.finish(nodes, color, 0.8)
    black = materials.wood("frame", (0.012, 0.009, 0.007), (0.04, 0.03, 0.022), 0.3)
    mount = materials.matte("mount", (0.82, 0.81, 0.78))
    x, y, z = location
    geometry.box("mount", (0.58, 0.010, 0.46), location, mount, edge=0.0)
    geometry.box(
        "print", (0.40, 0.004, 0.29), (x, y - 0.0045, z + 0.01), material, edge=0
    )
    for dx, dz, size in (
        (0, 0.235, (0.62, 0.03, 0.022)),
        (0, -0.235, (0.62, 0.03, 0.022)),
        (0.299, 0, (0.022, 0.03, 0.47)),
        (-0.299, 0, (0.022, 0.03, 0.47)),
    ):
        geometry.box("frame", size, (x + dx, y - 0.006, z + dz), black)


def stool(location):
    """A round stool with a checked cushion, at (x, y)."""
    x, y = location
    beech = materials.wood("beech", (0.34, 0.19, 0.09), (0.55, 0.36, 0.2), 0.4, "z")
    cloth = materials.weave(
        "cushion", (0.62, 0.42, 0.04), (0.35, 0.2, 0.02), 0.009, 0.05
    )
    profile = [
        (0, 0),
        (0.15, 0.0),
        (0.175, 0.012),
        (0.18, 0.03),
        (0.165, 0.05),
        (0.10, 0.062),
        (0, 0.066),
    ]
    geometry.lathe("cushion", profile, (x, y, 0.475), cloth)
    geometry.cylinder("seat", 0.17, 0.03, (x, y, 0.445), beech, edge=0.008)
    for dx, dy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        geometry.tube(
            "stool_leg",
            [(x + 0.10 * dx, y + 0.10 * dy, 0.45), (x + 0.15 * dx, y + 0.15 * dy, 0.0)],
            0.014,
            beech,
        )
