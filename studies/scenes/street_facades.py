# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Facades of the night street: piers, bands, lit windows, shops. Lengths in metres."""

import scene_geometry as geometry
import scene_materials as materials
from scene_render import light

WALL = 6.9  # distance of the facades from the middle of the road
RECESS = 0.22  # depth of the window plane behind the facade
GROUND, STOREY, BAY = 3.6, 3.1, 2.1
WALLS = (
    ("brick", (0.28, 0.085, 0.05)),
    ("stucco", (0.42, 0.36, 0.25)),
    ("brick", (0.20, 0.15, 0.11)),
    ("stucco", (0.34, 0.35, 0.36)),
    ("stucco", (0.40, 0.22, 0.14)),
)

GOODS = (
    (0.5, 0.02, 0.02),
    (0.7, 0.45, 0.02),
    (0.03, 0.12, 0.4),
    (0.6, 0.56, 0.48),
    (0.04, 0.25, 0.08),
    (0.55, 0.2, 0.03),
    (0.25, 0.04, 0.22),
    (0.7, 0.68, 0.62),
    (0.05, 0.05, 0.06),
    (0.35, 0.2, 0.1),
)


def brick(color):
    """Return running bond on vertical faces of any direction, 0.24 m by 0.075 m."""
    material, nodes = materials.begin("brick")
    parts = nodes.add("SeparateXYZ", {0: nodes.coordinates()}).outputs
    along = nodes.math("ADD", parts[0], parts[1])
    flat = nodes.add("CombineXYZ", {0: along, 1: parts[2]}).outputs[0]
    bond = nodes.add(
        "TexBrick",
        {
            "Vector": flat,
            "Color1": color,
            "Color2": [0.55 * c for c in color],
            "Mortar": (0.16, 0.15, 0.14),
            "Scale": 1.0,
            "Mortar Size": 0.006,
            "Brick Width": 0.24,
            "Row Height": 0.075,
        },
    )
    soot = nodes.noise(nodes.coordinates(), 0.9, 7.0, 0.65)
    color = nodes.mix(
        nodes.remap(soot, 0.4, 0.7, 0.0, 0.5),
        bond.outputs["Color"],
        (0.03, 0.028, 0.026),
    )
    depth = nodes.math("MULTIPLY", bond.outputs["Fac"], -1.0)
    materials.finish(nodes, color, 0.6, nodes.bump(depth, 0.008, 0.6))
    return material


def lit_pane(name, color, strength):
    """Return a window with the light on: curtains to the sides, brighter below."""
    material, nodes = materials.begin(name)
    parts = nodes.add("SeparateXYZ", {0: nodes.coordinates(space="Generated")}).outputs
    across = nodes.math("ABSOLUTE", nodes.math("SUBTRACT", parts[1], 0.5))
    chance = nodes.add("ObjectInfo").outputs["Random"]
    drawn = nodes.remap(chance, 0.0, 1.0, 0.10, 0.55)
    curtain = nodes.remap(nodes.math("SUBTRACT", across, drawn), -0.01, 0.01)
    wobble = nodes.noise(nodes.coordinates((22.0, 22.0, 1.0)), 1.0, 3.0)
    folds = nodes.remap(wobble, 0.3, 0.7, 0.25, 0.6)
    shade = nodes.remap(parts[2], 0.0, 1.0, 0.45, 1.2)
    room = nodes.math(
        "MULTIPLY",
        shade,
        nodes.remap(nodes.noise(nodes.coordinates(), 2.2, 5.0), 0.35, 0.65, 0.3, 1.3),
    )
    level = nodes.mix(curtain, room, folds)
    power = nodes.math(
        "MULTIPLY", level, nodes.remap(chance, 0, 1, 0.4 * strength, 1.5 * strength)
    )
    materials.finish(
        nodes,
        (0.01, 0.01, 0.01),
        0.05,
        Emission_Color=(*color, 1.0),
        Emission_Strength=power,
    )
    material.cycles.emission_sampling = "NONE"
    return material


def panes():
    """Return the window materials and how often each occurs."""
    dark = materials.plain("dark_pane", (0.006, 0.007, 0.009), 0.04)
    warm = lit_pane("warm_pane", (1.0, 0.56, 0.22), 1.1)
    amber = lit_pane("amber_pane", (1.0, 0.40, 0.10), 0.7)
    cool = lit_pane("cool_pane", (0.70, 0.88, 1.0), 0.9)
    screen = lit_pane("screen_pane", (0.22, 0.40, 1.0), 0.4)
    return (dark, warm, amber, cool, screen), (60, 18, 12, 7, 3)


def across(side, near, far):
    """Return the x range between two distances behind the facade line, ordered."""
    return sorted((side * (WALL + near), side * (WALL + far)))


def upper_storeys(rng, side, y0, y1, storeys, wall, glazing):
    """Windows between piers and bands from the first floor to the cornice."""
    choices, weights = glazing
    frame = materials.plain("frame", (0.30, 0.29, 0.27), 0.4)
    bays = max(2, round((y1 - y0) / BAY))
    width = (y1 - y0) / bays
    top = GROUND + storeys * STOREY
    x0, x1 = across(side, 0.0, RECESS + 0.3)
    for bay in range(bays + 1):
        y = y0 + bay * width
        low, high = max(y0 + 0.004, y - 0.48), min(y1 - 0.004, y + 0.48)
        geometry.span("pier", (x0, low, GROUND), (x1, high, top), wall, edge=0.006)
    for floor in range(storeys + 1):
        z = GROUND + floor * STOREY
        b0, b1 = across(side, -0.03, RECESS + 0.28)
        geometry.span(
            "band",
            (b0, y0 + 0.002, z - 0.55),
            (b1, y1 - 0.002, z + 0.72),
            wall,
            edge=0.006,
        )
    s0, s1 = across(side, -0.10, RECESS)
    f0, f1 = across(side, RECESS - 0.06, RECESS + 0.01)
    for floor in range(storeys):
        z = GROUND + floor * STOREY + 0.72
        tall = STOREY - 1.27
        for bay in range(bays):
            y = y0 + (bay + 0.5) * width
            half = width / 2 - 0.48
            glass = rng.choices(choices, weights)[0]
            p0, p1 = across(side, RECESS, RECESS + 0.02)
            geometry.span(
                "pane", (p0, y - half, z), (p1, y + half, z + tall), glass, edge=0
            )
            geometry.span(
                "sill",
                (s0, y - half - 0.1, z - 0.08),
                (s1, y + half + 0.1, z),
                frame,
                edge=0.01,
            )
            geometry.span("mullion", (f0, y - 0.03, z), (f1, y + 0.03, z + tall), frame)
            geometry.span(
                "transom",
                (f0, y - half, z + 0.66 * tall - 0.025),
                (f1, y + half, z + 0.66 * tall + 0.025),
                frame,
            )
    c0, c1 = across(side, -0.35, 0.5)
    geometry.span("cornice", (c0, y0, top + 0.2), (c1, y1, top + 0.62), wall, edge=0.03)


def stock(rng, side, y0, y1, goods):
    """Shelves on the far end wall of a shop, in view of who walks up the street."""
    shelf = materials.wood("shop_shelf", (0.14, 0.07, 0.03), (0.3, 0.18, 0.09), 0.4)
    s0, s1 = across(side, 0.35, 2.2)
    for z in (0.62, 1.06, 1.50, 1.94, 2.38):
        geometry.span("shelf", (s0, y1 - 0.36, z - 0.03), (s1, y1 - 0.02, z), shelf)
        x = s0 + 0.03
        while x < s1 - 0.2:
            wide, tall = rng.uniform(0.06, 0.2), rng.uniform(0.10, 0.34)
            geometry.span(
                "goods",
                (x, y1 - 0.33, z),
                (x + wide, y1 - 0.08, z + tall),
                rng.choice(goods),
                edge=0.01,
            )
            x += wide + rng.choice((0.005, 0.01, 0.02, 0.14))
    for y in (y0 + 1.0, (y0 + y1) / 2 + 0.4):
        low, high = across(side, 0.5, 1.1)
        geometry.span("counter", (low, y, 0.15), (high, y + 1.1, 0.85), shelf)
        for step in range(4):
            geometry.ball(
                "display",
                rng.uniform(0.08, 0.13),
                (side * (WALL + 0.8), y + 0.15 + 0.26 * step, 0.95),
                rng.choice(goods),
            )


def shop(rng, side, y0, y1, color, power, goods):
    """A lit shop behind glass: pale walls, goods, a ceiling light of @p power W."""
    x0, x1 = across(side, 0.15, 2.6)
    i0, i1 = across(side, 2.3, 2.4)
    pale = materials.plaster("shop_wall", (0.55, 0.52, 0.47), 0.001, 40.0)
    geometry.span("shop_back", (i0, y0, 0.1), (i1, y1, 3.0), pale, edge=0.0)
    geometry.span(
        "shop_end", (x0, y1 - 0.02, 0.1), (x1, y1 + 0.02, 3.0), pale, edge=0.0
    )
    geometry.span("shop_ceiling", (x0, y0, 2.98), (x1, y1, 3.05), pale, edge=0.0)
    geometry.span("shop_floor", (x0, y0, 0.1), (x1, y1, 0.15), pale, edge=0.0)
    stock(rng, side, y0, y1, goods)
    bar = materials.plain("shop_frame", (0.02, 0.02, 0.022), 0.3)
    g0, g1 = across(side, 0.12, 0.2)
    count = max(2, round((y1 - y0) / 1.6))
    for step in range(count + 1):
        y = y0 + (y1 - y0) * step / count
        geometry.span("shop_bar", (g0, y - 0.035, 0.13), (g1, y + 0.035, 3.0), bar)
    geometry.span("shop_base", (g0, y0, 0.13), (g1, y1, 0.5), bar)
    middle = (side * (WALL + 1.1), (y0 + y1) / 2, 2.9)
    light(
        "AREA",
        middle,
        power,
        color=color,
        target=(middle[0], middle[1], 0),
        shape="RECTANGLE",
        size=1.2,
        size_y=(y1 - y0) * 0.8,
    )


def shutter(side, y0, y1):
    """A closed rolling shutter."""
    steel = materials.metal("shutter", (0.30, 0.31, 0.32), 0.35)
    x0, x1 = across(side, 0.2, 0.24)
    for step in range(28):
        z = 0.14 + step * 0.104
        geometry.span("slat", (x0, y0, z), (x1, y1, z + 0.1), steel, edge=0.012)


def building(rng, side, y0, y1, storeys, wall, glazing, goods, is_shop):
    """One house: ground floor with a shop or a shutter, then its storeys."""
    b0, b1 = across(side, 0.0, 2.7)
    top = GROUND + storeys * STOREY
    r0, r1 = across(side, 2.6, 3.0)
    geometry.span("house", (r0, y0, 0), (r1, y1, top), wall, edge=0.0)
    u0, u1 = across(side, RECESS + 0.02, 2.7)
    geometry.span("upper", (u0, y0, 3.1), (u1, y1, top), wall, edge=0.0)
    for low, high in ((y0, y0 + 0.5), (y1 - 0.5, y1)):
        geometry.span(
            "corner",
            (b0, low + 0.006, 0),
            (b1, high - 0.006, GROUND - 0.5),
            wall,
            edge=0.006,
        )
    upper_storeys(rng, side, y0, y1, storeys, wall, glazing)
    if is_shop:
        tint = rng.choice(((1.0, 0.66, 0.34), (1.0, 0.80, 0.58), (0.78, 0.92, 1.0)))
        shop(rng, side, y0 + 0.5, y1 - 0.5, tint, rng.uniform(45, 95), goods)
    else:
        shutter(side, y0 + 0.5, y1 - 0.5)


def row(rng, side):
    """All houses of one side of the street (-1 left, 1 right)."""
    glazing, y, index = panes(), -9.0, 0
    goods = [materials.plain("goods", hue, 0.3) for hue in GOODS]
    while y < 64:
        kind, color = WALLS[(index * 2 + (side > 0)) % len(WALLS)]
        wall = (
            brick(color)
            if kind == "brick"
            else materials.plaster("stucco", color, 0.003, 25.0, 0.4)
        )
        length = rng.uniform(8.0, 12.5)
        building(
            rng,
            side,
            y,
            y + length,
            rng.choice((3, 3, 4, 5)),
            wall,
            glazing,
            goods,
            (index + 3 + (side > 0)) % 4 != 0,
        )
        y += length
        index += 1


def closing(rng, y):
    """The house across the end of the street, dimly lit."""
    choices, weights = panes()
    wall = materials.plaster("end_wall", (0.3, 0.27, 0.22), 0.003, 25.0, 0.4)
    geometry.span("end", (-40, y, 0), (40, y + 3, 19), wall, edge=0.0)
    for floor in range(5):
        for bay in range(-12, 13):
            place = (bay * 2.3, y - 0.02, 2.2 + floor * 3.3)
            geometry.box(
                "pane",
                (1.2, 0.06, 1.8),
                place,
                rng.choices(choices, weights)[0],
                edge=0.0,
            )
