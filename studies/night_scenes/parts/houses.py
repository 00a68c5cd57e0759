# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rows of houses from the night street's facades, and distant towers. Metres."""

from ..choices.colour import lamp_rgb
from ..choices.draws import BAY, STOREY
from .library import facades, geometry, group, materials

GOODS_ROUGHNESS = 0.3


def rows(scene_rows, rng):
    """Build rows of houses; @rng draws windows and goods."""
    if not scene_rows:
        return
    glazing = facades.panes()
    goods = [materials.plain("goods", hue, GOODS_ROUGHNESS) for hue in facades.GOODS]
    for row in scene_rows:
        with group(row.place, row.turn):
            # The facades' own plane lies WALL from the middle of their road.
            with group((-row.side * facades.WALL, 0.0, 0.0)):
                for house in row.houses:
                    one_house(house, row.side, rng, glazing, goods)


def one_house(house, side, rng, glazing, goods):
    """Build one house: its ground floor with a shop or a shutter, then its storeys."""
    wall = (
        facades.brick(house.shade)
        if house.wall == "brick"
        else materials.plaster("stucco", house.shade, 0.003, 25.0, 0.4)
    )
    y0, y1 = house.start, house.end
    top = facades.GROUND + house.storeys * facades.STOREY
    r0, r1 = facades.across(side, 2.6, 3.0)
    geometry.span("house", (r0, y0, 0), (r1, y1, top), wall, edge=0.0)
    u0, u1 = facades.across(side, facades.RECESS + 0.02, 2.7)
    geometry.span("upper", (u0, y0, 3.1), (u1, y1, top), wall, edge=0.0)
    b0, b1 = facades.across(side, 0.0, 2.7)
    for low, high in ((y0, y0 + 0.5), (y1 - 0.5, y1)):
        low, high = low + 0.006, high - 0.006
        end = facades.GROUND - 0.5
        geometry.span("corner", (b0, low, 0), (b1, high, end), wall, edge=0.006)
    facades.upper_storeys(rng, side, y0, y1, house.storeys, wall, glazing)
    if house.shop:
        tint = [c / 1.8 for c in lamp_rgb(house.shop_kelvin)]
        power = house.shop_power
        facades.shop(rng, side, y0 + 0.5, y1 - 0.5, tint, power, goods)
    elif house.storeys > 2:
        facades.shutter(side, y0 + 0.5, y1 - 0.5)
    else:
        home(rng, side, y0 + 0.5, y1 - 0.5, wall, glazing)


def home(rng, side, y0, y1, wall, glazing):
    """A ground floor with a door and two windows, of houses with one or two storeys."""
    x0, x1 = facades.across(side, 0.05, 0.4)
    geometry.span("wall", (x0, y0, 0), (x1, y1, facades.GROUND - 0.4), wall, edge=0.0)
    dark, middle = materials.plain("door", (0.05, 0.03, 0.02), 0.4), (y0 + y1) / 2
    d0, d1 = facades.across(side, 0.0, 0.2)
    geometry.span("door", (d0, middle - 0.5, 0), (d1, middle + 0.5, 2.15), dark)
    p0, p1 = facades.across(side, 0.03, 0.2)
    s0, s1 = facades.across(side, -0.06, 0.2)
    for y in ((y0 + middle) / 2 - 0.2, (y1 + middle) / 2 + 0.2):
        pane = rng.choices(*glazing)[0]
        low, high = (p0, y - 0.6, 0.95), (p1, y + 0.6, 2.3)
        geometry.span("pane", low, high, pane, edge=0.0)
        geometry.span("sill", (s0, y - 0.7, 0.86), (s1, y + 0.7, 0.95), dark)
        geometry.span("bar", (d0, y - 0.03, 0.95), (d1, y + 0.03, 2.3), dark)


def window_grid(tower):
    """Return walls with a window, lit or not, in each bay of each storey."""
    material, nodes = materials.begin("tower")
    position = nodes.add("TexCoord").outputs["Object"]
    x, y, z = (nodes.add("SeparateXYZ", {0: position}).outputs[k] for k in range(3))
    across = nodes.math("DIVIDE", nodes.math("ADD", x, y), BAY)
    up = nodes.math("DIVIDE", nodes.math("ADD", z, tower.size[2] / 2), STOREY)
    cell = nodes.add(
        "CombineXYZ",
        {
            0: nodes.math("FLOOR", across),
            1: nodes.math("FLOOR", up),
            2: float(tower.seed),
        },
    ).outputs[0]
    chance = nodes.add("TexWhiteNoise", {"Vector": cell}).outputs
    inside = nodes.math("MULTIPLY", between(nodes, across, 0.25, 0.75),
                        between(nodes, up, 0.28, 0.78))  # fmt: skip
    lit = nodes.math("LESS_THAN", chance[0], tower.lit)
    tint = nodes.add("SeparateColor", {0: chance[1]}).outputs
    warm = nodes.mix(tint[0], lamp_rgb(tower.kelvin), lamp_rgb(2600.0))
    level = nodes.remap(tint[1], 0.0, 1.0, 0.15 * tower.radiance, tower.radiance)
    strength = nodes.math("MULTIPLY", nodes.math("MULTIPLY", inside, lit), level)
    color = nodes.mix(inside, tower.shade, (0.01, 0.011, 0.012))
    rough = nodes.remap(inside, 0.0, 1.0, 0.7, 0.08)
    materials.finish(
        nodes, color, rough, Emission_Color=warm, Emission_Strength=strength
    )
    material.cycles.emission_sampling = "NONE"
    return material


def between(nodes, value, low, high):
    """Return 1 where the fraction of @value lies between two bounds, else 0."""
    part = nodes.math("FRACT", value)
    return nodes.math(
        "MULTIPLY",
        nodes.math("GREATER_THAN", part, low),
        nodes.math("LESS_THAN", part, high),
    )


def towers(scene_towers):
    """Build distant houses."""
    for tower in scene_towers:
        x, y, z = tower.place
        wide, deep, tall = tower.size
        middle = (x, y, z + tall / 2)
        geometry.box("tower", (wide, deep, tall), middle, window_grid(tower), edge=0.0)
