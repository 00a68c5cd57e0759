# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands in a street at night."""

import math
from dataclasses import dataclass

from . import crowd, draws, floor, houses
from .description import Camera, Scene, Sign

FAR = 66.0  # end of the street in metres
START = -9.0  # the first houses, behind the camera
KERB = 0.13  # height of the pavement


@dataclass(frozen=True)
class Layout:
    """A plan: half widths of road and street in metres, and how busy it is."""

    road: float
    wall: float
    storeys: tuple[int, ...]
    spacing: float  # of lamps
    shops: float
    signs: tuple[int, int]
    traffic: float
    parked: float
    trees: float = 0.0
    festoons: tuple[int, int] = (0, 2)
    buses: float = 0.0
    gap: float = 0.0
    people: tuple[int, int] = (4, 12)


LAYOUTS = {
    "alley": Layout(0.0, 2.9, (3, 4, 5), 13, 0.5, (7, 13), 0.0, 0.0, 0, (0, 3)),
    "lane": Layout(2.6, 5.0, (2, 3, 3), 15, 0.5, (2, 7), 0.25, 0.0, 0, (0, 3)),
    "street": Layout(4.2, 6.9, (3, 3, 4, 5), 17, 0.7, (3, 8), 0.5, 0.5),
    "avenue": Layout(7.0, 11.5, (4, 5, 6), 19, 0.8, (4, 10), 0.7, 0.5, 0.5),
    "boulevard": Layout(
        5.4, 12.5, (4, 5), 16, 0.9, (2, 6), 0.5, 0.6, 0.9, (2, 5), people=(10, 22)
    ),
    "suburb": Layout(
        3.6, 8.6, (1, 2, 2), 24, 0.0, (0, 0), 0.2, 0.5, 0.7, (0, 1), 0, 5.0, (1, 4)
    ),
    "bus road": Layout(6.2, 10.0, (3, 4), 18, 0.6, (3, 8), 0.6, 0.0, 0.2, (0, 1), 0.45),
    "forecourt": Layout(4.4, 13.0, (1, 2, 3), 20, 0.2, (1, 4), 0.4, 0.0, 0.3, gap=2.0),
}


def facing(side):
    """Return the turn of what looks from a side's wall or kerb across the street."""
    return -side * math.pi / 2


def camera(index, layout):
    """Draw where the picture is taken: pavement, roadway, a window, or low."""
    rng = draws.stream(index, "camera")
    height = rng.choice((1.6, 1.6, 1.5, 0.7, 2.6, 5.0))
    reach = layout.wall - 0.9
    x = rng.uniform(-reach, reach)
    if height == 5.0:
        x = math.copysign(layout.wall - 0.6, x)  # from a balcony
    aside = rng.uniform(-0.4, 0.4) * layout.wall - 0.35 * x
    target = (aside, 28.0, rng.uniform(1.2, 4.2))
    length = rng.choice((20, 24, 24, 28, 35, 50))
    return Camera((x, rng.uniform(-3, 2), height), target, length)


def rows(index, layout):
    """Draw both sides of the street and its end."""
    rng = draws.stream(index, "houses")
    length = FAR - START
    return tuple(
        houses.row(
            rng,
            (side * layout.wall, START, KERB if layout.road else 0.0),
            0.0,
            side,
            length,
            layout.storeys,
            layout.shops,
            layout.gap,
        )
        for side in (-1, 1)
    )


def lamps(index, layout, ground):
    """Draw the lamps: on poles at both kerbs, or on brackets of an alley's walls."""
    rng = draws.stream(index, "lamps")
    dead = rng.random() < 0.25
    found = []
    strength = layout.wall / 6.9
    for side in (-1, 1):
        light, turn = draws.white(rng), facing(side)
        y = rng.uniform(4, 10) + (layout.spacing / 2 if side > 0 else 0.0)
        while y < FAR - 4 and not (dead and side > 0):
            power = rng.uniform(300, 620) * strength
            if layout.road < 3:
                place = (side * layout.wall, y, rng.uniform(3.6, 4.6))
                found.append(draws.lamp(rng, "bracket", place, turn, light, power / 4))
            elif ground.take(floor.of("pole", side * (layout.road + 0.45), y)):
                place = (side * (layout.road + 0.45), y, KERB)
                found.append(draws.lamp(rng, "pole", place, turn, light, power))
            y += layout.spacing * rng.uniform(0.9, 1.1)
    return found


def signs(index, layout):
    """Draw signs along the facades, none over another."""
    rng = draws.stream(index, "signs")
    walls = {side: floor.Floor() for side in (-1, 1)}
    found = []
    for _ in range(rng.randint(*layout.signs)):
        side, size = rng.choice((-1, 1)), rng.uniform(0.4, 0.85)
        y, z = rng.uniform(6, 40), rng.uniform(3.9, 6.4)
        name = rng.choice(("blade", "column", "letters", "ring", "screen"))
        word, tint = rng.choice(draws.WORDS), draws.hue(rng)
        long, tall = draws.sign_size(name, word, size)
        place = (side * layout.wall, y, z + tall / 2)
        if walls[side].take(floor.Rectangle(y, place[2], long, tall), 0.3):
            strength = rng.uniform(10, 32)
            found.append(Sign(name, word, place, facing(side), *tint, strength, size))
    return tuple(found)


def traffic(index, layout, ground):
    """Draw who drives, comes or goes, and who is parked."""
    rng = draws.stream(index, "traffic")
    found = []
    bodies = (*draws.CAR_BODIES, *(("bus",) * (2 if layout.buses else 0)))
    one_way = layout.road < 3
    aside = layout.road * (0.26 if layout.parked else 0.45)
    if layout.road < 1.5:
        return found
    for side, turn in ((1, math.pi), (-1, 0.0)):
        x = 0.0 if one_way else side * aside
        if not one_way or side > 0:
            span, gap = (5.0, FAR - 10), (3.0, 16.0)
            found += crowd.lane(rng, ground, x, turn, span, gap, layout.traffic, bodies)
    for side in (-1, 1):
        if layout.parked:
            x = side * (layout.road - 1.05)
            turn = math.pi if side > 0 else 0.0
            span = (rng.uniform(2, 6), FAR - 16)
            found += crowd.lane(
                rng, ground, x, turn, span, (0.9, 3.0), layout.parked, lit=False
            )
    return found


def forecourt(rng, ground):
    """Draw the canopy of a petrol station with its lights."""
    x, y = 9.2, rng.uniform(16, 24)
    light = (rng.uniform(3800, 6200), rng.uniform(0.0, 0.01))
    size = (5.6, 12.0, 5.0)
    shade = rng.choice(((0.4, 0.03, 0.03), (0.03, 0.2, 0.08), (0.4, 0.3, 0.02)))
    things = crowd.put(rng, ground, "canopy", x, y, 0.0, size, shade)
    panels = [
        draws.lamp(
            rng, "panel", (x + dx, y + dy, 4.85), 0.0, light, rng.uniform(120, 220)
        )
        for dx in (-1.5, 1.5)
        for dy in (-4, 0, 4)
    ]
    return things, panels


def furniture(index, layout, ground):
    """Draw trees, benches, bicycles, bins, bollards."""
    rng = draws.stream(index, "furniture")
    things = []
    for side in (-1, 1):
        y = rng.uniform(3, 9)
        while layout.trees and y < FAR - 6:
            x = side * (layout.road + 1.3)
            if rng.random() < layout.trees and layout.wall - layout.road > 3:
                size = (0.7, 0.7, rng.uniform(4.5, 8))
                shade = (0.05, 0.11, 0.03)
                things += crowd.put(rng, ground, "tree", x, y, 0.0, size, shade, KERB)
            y += rng.uniform(6, 11)
        edge = sorted((side * (layout.road + 0.3), side * (layout.wall - 0.5)))
        area = (*edge, 3.0, 40.0)
        for name, most, size in (
            ("bin", 3, (0.6, 0.6, 1.0)),
            ("bollard", 4, (0.25, 0.25, 0.95)),
            ("bicycle", 3, (0.5, 1.8, 1.0)),
            ("box", 2, (0.7, 0.5, 0.6)),
        ):
            shade = rng.choice(draws.PAINTS)
            things += crowd.scatter(
                rng, ground, name, rng.randint(0, most), area, size, shade, False, KERB
            )
    return things


def choose(index, name):
    """Return the scene of the street called @name in LAYOUTS."""
    layout = LAYOUTS[name]
    ground = floor.Floor()
    view = camera(index, layout)
    ground.keep_clear(view)
    weather = draws.weather(index)
    rng = draws.stream(index, "people")
    things, panels = forecourt(rng, ground) if name == "forecourt" else ([], [])
    lights = (*lamps(index, layout, ground), *panels)
    vehicles = traffic(index, layout, ground)
    things += furniture(index, layout, ground)
    people = []
    for side in (-1, 1):
        edge = sorted((side * (layout.road + 0.3), side * (layout.wall - 0.4)))
        count = rng.randint(*layout.people) // 2
        height = KERB if layout.road else 0.0
        area = (*edge, 5.0, 38.0)
        people += crowd.people(rng, ground, count, area, height, weather.wet, view=view)
    people += crowd.seated(rng, things, 0.3, view)
    strings = []
    for _ in range(rng.randint(*layout.festoons)):
        y, wall, z = rng.uniform(9, 40), layout.wall, rng.uniform(5.2, 7.0)
        end = (wall, y + rng.uniform(-3, 3), rng.uniform(5.2, 7.0))
        strings.append(draws.festoon(rng, (-wall, y, z), end))
    return Scene(
        index,
        "street",
        name,
        {"road": layout.road, "wall": layout.wall, "far": FAR},
        view,
        draws.sky(index),
        weather,
        rows(index, layout),
        tuple(houses.skyline(rng, -40, 40, FAR + 6, (9, 26))),
        lights,
        signs(index, layout),
        tuple(strings),
        tuple(vehicles),
        tuple(people),
        tuple(things),
    )
