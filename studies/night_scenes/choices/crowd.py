# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""People, vehicles and small things put down where the ground is free."""

import math

from . import draws, floor

TRIES = 12


# Seats by the name of a thing: (x, y) as shares of its size, and the turn of who sits.
SEATS = {
    "bench": ((-0.25, 0.0, 0.0), (0.25, 0.0, 0.0)),
    "sofa": ((-0.22, -0.1, 0.0), (0.22, -0.1, 0.0)),
    "booth": (
        (-0.25, 0.36, 0.0),
        (0.22, 0.36, 0.0),
        (-0.22, -0.36, math.pi),
        (0.25, -0.36, math.pi),
    ),
}
NEAR = 4.5  # m, within which nobody stands before the camera


def seated(rng, things, share, view):
    """Return people on a share of the seats of @things, none right before @view."""
    found = []
    for thing in things:
        for across, along, turn in SEATS.get(thing.name, ()):
            dx, dy = across * thing.size[0], along * thing.size[1]
            c, s = math.cos(thing.turn), math.sin(thing.turn)
            x, y, z = thing.place
            place = (x + c * dx - s * dy, y + s * dx + c * dy, z)
            if rng.random() < share and math.dist(place[:2], view.place[:2]) > NEAR / 2:
                found.append(draws.person(rng, "sitting", place, thing.turn + turn))
    return found


def people(
    rng, ground, count, area, height=0.0, wet=0.0, poses=draws.WALKING, view=None
):
    """Return up to @count figures within area (x0, x1, y0, y1), some in pairs.

    view : the camera, before which nobody stands nearer than NEAR."""
    x0, x1, y0, y1 = area
    found = []
    for _ in range(count * TRIES):
        if len(found) >= count:
            break
        x, y = rng.uniform(x0, x1), rng.uniform(y0, y1)
        turn = rng.uniform(-math.pi, math.pi)
        if view and math.dist((x, y), view.place[:2]) < NEAR:
            continue
        umbrella = wet > 0.5 and rng.random() < 0.5
        name = "umbrella" if umbrella else "person"
        if not ground.take(floor.of(name, x, y, turn)):
            continue
        found.append(
            draws.person(rng, rng.choice(poses), (x, y, height), turn, umbrella)
        )
        beside = (x + 0.75 * math.cos(turn), y + 0.75 * math.sin(turn))
        is_pair = rng.random() < 0.4 and not umbrella and x0 < beside[0] < x1
        if is_pair and ground.take(floor.of("person", *beside, turn), 0.02):
            found.append(draws.person(rng, rng.choice(poses), (*beside, height), turn))
    return found[:count]


def lane(rng, ground, x, turn, span, gap, share, bodies=draws.CAR_BODIES, lit=True):
    """Return vehicles along a lane at @x, from span[0] to span[1], @gap metres apart.

    gap : (least, most) free metres before each place; share of the places is used."""
    found, y = [], span[0] + rng.uniform(0, gap[1])
    while y < span[1]:
        body = rng.choice(bodies)
        length = floor.FOOTPRINTS[body][1]
        place = (x + rng.uniform(-0.15, 0.15), y + length / 2)
        spot = floor.of(body, *place, turn)
        if rng.random() < share and ground.take(spot, 0.4):
            found.append(draws.vehicle(rng, body, (*place, 0.0), turn, lit))
        y += length + rng.uniform(*gap)
    return found


def scatter(rng, ground, name, count, area, size, shade, turned=True, height=0.0):
    """Return up to @count things of one name, size (width, length, height), in area."""
    found = []
    for _ in range(count * TRIES):
        if len(found) >= count:
            break
        x, y = rng.uniform(*area[:2]), rng.uniform(*area[2:])
        turn = rng.uniform(-math.pi, math.pi) if turned else 0.0
        if ground.take(floor.Rectangle(x, y, size[0], size[1], turn), 0.25):
            found.append(draws.thing(rng, name, (x, y, height), turn, size, shade))
    return found


def put(rng, ground, name, x, y, turn, size, shade, height=0.0, gap=0.05):
    """Return [the thing] at a place, or [] where something stands already."""
    if not ground.take(floor.Rectangle(x, y, size[0], size[1], turn), gap):
        return []
    return [draws.thing(rng, name, (x, y, height), turn, size, shade)]
