# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands in a room at night."""

import math
from dataclasses import dataclass

from . import crowd, draws, floor, furnishing
from .description import Camera, Scene


@dataclass(frozen=True)
class Layout:
    """A room: width, depth and height in m from-to, its floor and its lamps."""

    width: tuple[float, float]
    depth: tuple[float, float]
    height: tuple[float, float]
    floors: tuple[str, ...]
    lamp: str
    spacing: float  # m between lamps
    power: tuple[float, float]  # W of one
    kelvin: tuple[float, float]
    dim: float  # share of lamps that are off
    neon: tuple[int, int]
    window: bool
    people: tuple[int, int]


LAYOUTS = {
    "bar": Layout(
        (6, 8), (9, 12), (2.9, 3.4), ("planks", "tiles"), "pendant", 1.9, (7, 16),
        (2000, 2700), 0.3, (3, 7), False, (2, 6),
    ),  # fmt: skip
    "station": Layout(
        (11, 14), (34, 42), (4.4, 5.4), ("tiles", "terrazzo"), "tube", 3.6, (40, 90),
        (2900, 6000), 0.2, (1, 3), False, (6, 18),
    ),  # fmt: skip
    "shop": Layout(
        (8, 11), (14, 20), (3.0, 3.6), ("tiles", "terrazzo"), "panel", 2.6, (22, 40),
        (2700, 5600), 0.1, (1, 3), False, (2, 7),
    ),  # fmt: skip
    "diner": Layout(
        (6, 8), (10, 14), (2.9, 3.3), ("checks", "tiles"), "pendant", 2.2, (8, 18),
        (2100, 3200), 0.1, (2, 5), True, (1, 4),
    ),  # fmt: skip
    "office": Layout(
        (8, 11), (11, 15), (2.8, 3.1), ("carpet",), "panel", 2.6, (18, 34),
        (2900, 5200), 0.6, (0, 1), True, (1, 4),
    ),  # fmt: skip
    "living room": Layout(
        (4.5, 6), (6, 8), (2.6, 2.9), ("planks", "carpet"), "pendant", 3.2, (9, 20),
        (2000, 2900), 0.3, (0, 1), True, (1, 3),
    ),  # fmt: skip
    "arcade": Layout(
        (8, 10), (12, 16), (3.0, 3.6), ("carpet", "checks"), "pendant", 4.0, (4, 8),
        (2200, 4000), 0.5, (5, 9), False, (3, 9),
    ),  # fmt: skip
    "garage": Layout(
        (14, 17), (28, 36), (2.6, 2.9), ("concrete",), "tube", 4.6, (26, 50),
        (2600, 5200), 0.3, (0, 1), False, (0, 3),
    ),  # fmt: skip
}  # fmt: skip
TOWERS = ((8, 14), (8, 14), (18, 44))  # m: what windows show
WALLS = (
    (0.55, 0.50, 0.42),
    (0.42, 0.16, 0.10),
    (0.16, 0.26, 0.24),
    (0.30, 0.32, 0.36),
    (0.60, 0.58, 0.54),
    (0.14, 0.12, 0.16),
    (0.52, 0.38, 0.16),
)


def lamps(index, layout, width, depth, height):
    """Draw the ceiling's lamps on a grid, some of them off."""
    rng = draws.stream(index, "lamps")
    light = (rng.uniform(*layout.kelvin), rng.uniform(-0.003, 0.010))
    columns = max(1, round(width / layout.spacing) - 1)
    found = []
    y = layout.spacing * 0.7
    while y < depth - 0.6:
        for column in range(columns):
            x = width * ((column + 0.5) / columns - 0.5)
            if rng.random() >= layout.dim:
                place, power = (x, y, height), rng.uniform(*layout.power)
                found.append(draws.lamp(rng, layout.lamp, place, 0.0, light, power))
        y += layout.spacing
    if not found:
        middle = (0.0, depth / 2, height)
        power = max(layout.power)
        found.append(draws.lamp(rng, layout.lamp, middle, 0.0, light, power))
    return found


def signs(index, layout, width, depth, height):
    """Draw neon and screens on the back wall and the two sides, none over another."""
    rng = draws.stream(index, "signs")
    walls = {turn: floor.Floor() for turn in (0.0, math.pi / 2, -math.pi / 2)}
    found = []
    for _ in range(rng.randint(*layout.neon)):
        turn = rng.choice(tuple(walls))
        name = rng.choice(("letters", "letters", "ring", "strip"))
        size = rng.uniform(0.22, 0.42)
        new = draws.sign(rng, name, (0, 0, 0), turn, size, rng.uniform(6, 16))
        if turn and layout.window and turn < 0:
            continue  # the windows' wall
        long = 2.4 if name == "strip" else 0.8 * size * len(new.text)
        room = (width if turn == 0.0 else depth) - long - 1.0
        if room <= 0:
            continue
        along = rng.uniform(-room / 2, room / 2)
        z = rng.uniform(1.9, height - 0.5)
        if walls[turn].take(floor.Rectangle(along, z, long, 2 * size), 0.1):
            side = -math.copysign(width / 2, turn)
            place = (along, depth) if turn == 0.0 else (side, depth / 2 + along)
            found.append(draws.moved(new, (*place, z)))
    return found


def cars(rng, ground, width, depth):
    """Draw cars that stand in a garage's bays."""
    found = []
    for side in (-1, 1):
        y = 6.5
        while y < depth - 2:
            body = rng.choice(draws.CAR_BODIES)
            x, turn = (
                side * (width / 2 - 2.8),
                side * math.pi / 2 * rng.choice((1, 1, -1)),
            )
            if rng.random() < 0.6 and ground.take(floor.of(body, x, y, turn), 0.2):
                lit = rng.random() < 0.08
                found.append(draws.vehicle(rng, body, (x, y, 0.0), turn, lit))
            y += 2.6
    return found


def choose(index, name):
    """Return the room called @name in LAYOUTS."""
    layout, rng = LAYOUTS[name], draws.stream(index, "room")
    width, depth = rng.uniform(*layout.width), rng.uniform(*layout.depth)
    height = rng.uniform(*layout.height)
    x = rng.uniform(-0.3, 0.3) * width
    target = (-0.5 * x + rng.uniform(-0.15, 0.15) * width, depth * 0.7, 1.25)
    eye = rng.choice((1.2, 1.55, 1.6, 2.1))
    view = Camera((x, 0.35, eye), target, rng.choice((18, 20, 24, 28)))
    ground = floor.Floor()
    ground.keep_clear(view, 2.2, 1.4)
    vehicles = cars(rng, ground, width, depth) if name == "garage" else []
    things = furnishing.FURNISH[name](rng, ground, width, depth)
    area = (-width / 2 + 0.5, width / 2 - 0.5, 2.6, depth - 0.8)
    poses = ("standing", "phone", "standing", "walking")
    count = rng.randint(*layout.people)
    people = crowd.people(rng, ground, count, area, 0.0, 0.0, poses, view)
    people += crowd.seated(rng, things, 0.35, view)
    stage = {"width": width, "depth": depth, "height": height}
    stage |= {"floor": rng.choice(layout.floors), "wall": rng.choice(WALLS)}
    stage |= {"window": layout.window}
    return Scene(
        index,
        "interior",
        name,
        stage,
        view,
        draws.sky(index),
        draws.weather(index, True),
        towers=tuple(outside(rng, width)) if layout.window else (),
        lamps=tuple(lamps(index, layout, width, depth, height)),
        signs=tuple(signs(index, layout, width, depth, height)),
        vehicles=tuple(vehicles),
        people=tuple(people),
        things=tuple(things),
    )


def outside(rng, width):
    """Draw the houses that the windows of the right wall show."""
    return [
        draws.tower(
            rng,
            (width / 2 + rng.uniform(22, 40), y, -14.0),
            draws.whole_bays(*(rng.uniform(*ends) for ends in TOWERS)),
        )
        for y in (-6.0, 8.0, 22.0, 38.0)
    ]
