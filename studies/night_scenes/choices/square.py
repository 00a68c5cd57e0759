# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands in a square or a market at night."""

import math

from . import crowd, draws, floor, houses
from .colour import neon_rgb
from .description import Camera, Scene

LAYOUTS = (
    "market rows",
    "market ring",
    "fountain",
    "fair",
    "terrace",
    "bus station",
    "church",
    "car park",
)
HALF, DEPTH = (15.0, 22.0), (30.0, 42.0)  # m: half width and depth, from-to
STALL = (2.6, 2.0, 2.7)  # width, depth, height in m
STONE = (0.32, 0.30, 0.27)
STALL_KELVIN = (2000.0, 4200.0)


def camera(index, half):
    """Draw where the picture is taken: among people, or from a window above."""
    rng = draws.stream(index, "camera")
    height = rng.choice((1.6, 1.6, 1.5, 1.0, 3.2, 6.5))
    x = rng.uniform(-0.6, 0.6) * half
    target = (rng.uniform(-0.7, 0.7) * half - 0.3 * x, 24.0, rng.uniform(1.5, 4.0))
    return Camera((x, rng.uniform(-4, 1), height), target, rng.choice((18, 22, 26, 32)))


def rows(index, half, depth):
    """Draw houses around three sides."""
    rng = draws.stream(index, "houses")
    storeys = rng.choice(((2, 3), (3, 4), (4, 5, 6)))
    shops = rng.uniform(0.3, 0.9)
    side = [
        houses.row(rng, (s * half, -8.0, 0.0), 0.0, s, depth + 5.0, storeys, shops)
        for s in (-1, 1)
    ]
    back = (half, depth, 0.0)
    length = 2 * half
    return (*side, houses.row(rng, back, math.pi / 2, 1, length, storeys, shops))


def stall(rng, ground, x, y, turn):
    """Return a market stall and its lamp, or nothing where there is no room."""
    hue = neon_rgb(rng.random(), rng.uniform(0.5, 0.9))
    cloth = tuple(0.05 + 0.5 * c for c in hue)
    made = crowd.put(rng, ground, "stall", x, y, turn, STALL, cloth, gap=0.3)
    if not made:
        return [], []
    light = (rng.uniform(*STALL_KELVIN), rng.uniform(-0.002, 0.01))
    place = (x, y, STALL[2] - 0.35)
    return made, [draws.lamp(rng, "bulb", place, turn, light, rng.uniform(14, 34))]


def market(rng, ground, layout, half):
    """Draw the stalls of a market, in rows or in a ring."""
    things, lamps = [], []
    if layout == "market ring":
        count, radius = rng.randint(8, 11), rng.uniform(7.5, 9.5)
        spots = []
        for step in range(count):
            angle = 2 * math.pi * step / count
            x, y = radius * math.sin(angle), 17 - radius * math.cos(angle)
            spots.append((x, y, -angle if rng.random() < 0.8 else math.pi - angle))
    else:
        aisle = rng.uniform(5.0, 6.5)
        columns = [
            c * aisle for c in (-1.5, -0.5, 0.5, 1.5) if abs(c * aisle) < half - 3
        ]
        spots = [
            (x, y, -math.copysign(math.pi / 2, x) * rng.choice((1, 1, -1)))
            for x in columns
            for y in (6.0, 9.4, 12.8, 16.2, 19.6, 23.0)
            if rng.random() < 0.8
        ]
    for x, y, turn in spots:
        made, lit = stall(rng, ground, x, y, turn)
        things += made
        lamps += lit
    return things, lamps


def fountain(rng, ground, half, depth):
    """Return a fountain near the middle."""
    x, y, size = rng.uniform(-2, 2), rng.uniform(15, 18), (5.0, 5.0, 2.4)
    return crowd.put(rng, ground, "fountain", x, y, 0.0, size, (0.3, 0.3, 0.3)), [], []


def church(rng, ground, half, depth):
    """Return a church in the flood of two lamps, and a monument before it."""
    size, spot = (8.0, 9.0, rng.uniform(20, 28)), (rng.uniform(-6, 6), depth - 8)
    things = crowd.put(rng, ground, "church", *spot, 0.0, size, STONE)
    x, size = rng.uniform(-3, 3), (2.2, 2.2, 5.0)
    things += crowd.put(rng, ground, "monument", x, 14.0, 0.0, size, STONE)
    lamps = []
    for side in (-1, 1):
        light, place = draws.white(rng), (spot[0] + side * 5.5, spot[1] - 7.5, 0.3)
        lamps.append(draws.lamp(rng, "flood", place, side * 0.35, light, 900.0))
    return things, lamps, []


def fair(rng, ground, half, depth):
    """Return a roundabout, a lit tree, and stalls at both sides."""
    x, y, size = rng.uniform(-6, 6), rng.uniform(16, 20), (7.0, 7.0, 4.2)
    hue = neon_rgb(rng.random(), 0.8)
    things, lamps = crowd.put(rng, ground, "carousel", x, y, 0.0, size, hue), []
    spot = (-math.copysign(7.0, x), rng.uniform(11, 22))
    size = (4.0, 4.0, rng.uniform(7, 10))
    things += crowd.put(rng, ground, "lit_tree", *spot, 0.0, size, (0.02, 0.07, 0.02))
    for x in (-half + 4, half - 4):
        for y in (8.0, 12.0, 16.0):
            made, lit = stall(rng, ground, x, y, -math.copysign(math.pi / 2, x))
            things += made
            lamps += lit
    return things, lamps, []


def bus_station(rng, ground, half, depth):
    """Return buses side by side and shelters before them."""
    things, vehicles = [], []
    for step in range(rng.randint(3, 5)):
        x, size = -half + 6 + step * 5.2, (3.4, 1.4, 2.5)
        vehicles += parked(rng, ground, "bus", x, 20.0, 0.35, rng.random() < 0.5)
        things += crowd.put(rng, ground, "shelter", x + 0.6, 11.2, 0.0, size, STONE)
    return things, [], vehicles


def car_park(rng, ground, half, depth):
    """Return cars in three rows."""
    vehicles = []
    for y in (8.0, 14.5, 21.0):
        x = -half + 3
        while x < half - 3:
            body, back = rng.choice(draws.CAR_BODIES), rng.choice((0.0, math.pi))
            if rng.random() < 0.7:
                lit = rng.random() < 0.06
                vehicles += parked(rng, ground, body, x, y, back, lit)
            x += 2.7
    return [], [], vehicles


MIDDLES = {
    "market ring": fountain,
    "fountain": fountain,
    "church": church,
    "fair": fair,
    "bus station": bus_station,
    "car park": car_park,
}


def middle(rng, ground, layout, half, depth):
    """Draw what the square is named for. Returns things, lamps, vehicles."""
    draw = MIDDLES.get(layout)
    return draw(rng, ground, half, depth) if draw else ([], [], [])


def parked(rng, ground, body, x, y, turn, lit):
    """Return [the vehicle], or [] where something stands."""
    if not ground.take(floor.of(body, x, y, turn), 0.3):
        return []
    return [draws.vehicle(rng, body, (x, y, 0.0), turn, lit)]


def poles(index, ground, half, depth):
    """Draw lamp posts around the square."""
    rng = draws.stream(index, "lamps")
    light, name = draws.white(rng), rng.choice(("post", "post", "pole"))
    found = []
    for side in (-1, 1):
        y = rng.uniform(3, 7)
        while y < depth - 4:
            x = side * (half - 3.2)
            if ground.take(floor.of("pole", x, y), 0.2):
                power = rng.uniform(120, 240) * (2.2 if name == "pole" else 1.0)
                turn = -side * math.pi / 2
                found.append(draws.lamp(rng, name, (x, y, 0), turn, light, power))
            y += rng.uniform(8, 11)
    return found


def strings(index, half):
    """Draw festoons between poles of houses, more in a fair."""
    rng = draws.stream(index, "festoons")
    found = []
    for _ in range(rng.choice((0, 0, 2, 4, 6))):
        y, z = rng.uniform(6, 26), rng.uniform(5.0, 7.0)
        end = (half, y + rng.uniform(-5, 5), rng.uniform(5.0, 7.0))
        found.append(draws.festoon(rng, (-half, y, z), end))
    return found


def signs(index, half, depth):
    """Draw signs on the back row and on the sides, none over another."""
    rng = draws.stream(index, "signs")
    wall, found = floor.Floor(), []
    for _ in range(rng.randint(1, 7)):
        name = rng.choice(("letters", "screen", "ring", "letters"))
        size = rng.uniform(0.6, 1.1)
        new = draws.sign(rng, name, (0, 0, 0), 0.0, size)
        x, z = rng.uniform(-half + 4, half - 4), rng.uniform(4.0, 7.0)
        long, tall = draws.sign_size(name, new.text, size)
        if wall.take(floor.Rectangle(x, z, long, tall), 0.4):
            found.append(draws.moved(new, (x, depth, z + tall / 2)))
    return found


def small(index, ground, layout, half, depth):
    """Draw trees, benches, tables, bicycles and bins."""
    rng = draws.stream(index, "furniture")
    area = (-half + 4, half - 4, 4.0, depth - 5)
    wood, dark = (0.20, 0.11, 0.05), (0.04, 0.045, 0.05)
    wanted = [
        (
            "tree",
            rng.randint(0, 7),
            (0.8, 0.8, rng.uniform(4.5, 7.5)),
            (0.05, 0.11, 0.03),
        ),
        ("bench", rng.randint(1, 5), (1.8, 0.6, 0.85), wood),
        ("bicycle", rng.randint(0, 4), (0.5, 1.8, 1.0), dark),
        ("bin", rng.randint(0, 3), (0.6, 0.6, 1.0), dark),
    ]
    if layout == "terrace":
        hue = neon_rgb(rng.random(), 0.8)
        cloth = tuple(0.1 + 0.5 * c for c in hue)
        wanted.insert(0, ("table_set", rng.randint(8, 14), (2.2, 2.2, 2.4), cloth))
    things = []
    for name, count, size, shade in wanted:
        if layout in ("car park", "bus station") and name == "tree":
            continue
        things += crowd.scatter(rng, ground, name, count, area, size, shade)
    return things


def choose(index, layout):
    """Return the scene of the square called @layout in LAYOUTS."""
    rng = draws.stream(index, "square")
    half, depth = rng.uniform(*HALF), rng.uniform(*DEPTH)
    ground = floor.Floor()
    view = camera(index, half)
    ground.keep_clear(view)
    weather = draws.weather(index)
    things, lamps, vehicles = middle(rng, ground, layout, half, depth)
    if layout.startswith("market"):
        made, lit = market(rng, ground, layout, half)
        things, lamps = things + made, lamps + lit
    lamps += poles(index, ground, half, depth)
    things += small(index, ground, layout, half, depth)
    area = (-half + 2, half - 2, 3.5, depth - 6)
    people = draws.stream(index, "people")
    count = people.randint(6, 26)
    crowd_of = crowd.people(people, ground, count, area, 0.0, weather.wet, view=view)
    crowd_of += crowd.seated(people, things, 0.3, view)
    sky = houses.skyline(people, -50, 50, depth + 12, (14, 34))
    return Scene(
        index,
        "square",
        layout,
        {"half": half, "depth": depth, "paving": rng.choice(("cobbles", "slabs"))},
        view,
        draws.sky(index),
        weather,
        rows(index, half, depth),
        tuple(sky),
        tuple(lamps),
        tuple(signs(index, half, depth)),
        tuple(strings(index, half)),
        tuple(vehicles),
        tuple(crowd_of),
        tuple(things),
    )
