# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A street and a square: where houses, lamps, cars, people and stalls stand."""

from dataclasses import dataclass

import numpy as np

from studies.mitsuba_judge import furniture
from studies.mitsuba_judge.buildings import house
from studies.mitsuba_judge.kit import Kit
from studies.mitsuba_judge.spectra import GROUND, PAVING
from studies.mitsuba_judge.things import Point, Spot, Thing

BEHIND = -9.0  # m: what is behind the camera still gives light
GROUND_SIDE = 240.0  # m
KERB = 0.12  # m
STANDING = (0.6, 0.28, 0.12)  # shares of people, clutter and trees


@dataclass(frozen=True)
class View:
    """Where the camera is, what it looks at, and its field of view across, degrees."""

    origin: Point
    target: Point
    field: float


def view(rng: np.random.Generator, sideways: float) -> View:
    """Return a view along z by somebody who stands within @sideways of the middle."""
    origin = (rng.uniform(-sideways, sideways), rng.uniform(1.3, 2.8), 0.0)
    target = (rng.uniform(-4.0, 4.0), rng.uniform(0.8, 3.4), 20.0)
    x, y, z = (float(value) for value in origin)
    to_x, to_y, to_z = (float(value) for value in target)
    return View((x, y, z), (to_x, to_y, to_z), float(rng.uniform(48.0, 74.0)))


def ground() -> Thing:
    """Return the ground: all that is not paved otherwise."""
    size = (GROUND_SIDE, 1.0, GROUND_SIDE)
    return Thing("box", (0.0, -0.5, 0.0), size, GROUND)


def row(kit: Kit, start: Spot, length: float) -> list[Thing]:
    """Return houses side by side, from @start on to the right of their fronts."""
    rng, things, done = kit.rng, list[Thing](), 0.0
    while done < length:
        width, back = float(rng.uniform(5.0, 12.0)), float(rng.uniform(0.0, 0.9))
        spot = Spot(start.at(done + width / 2, 0.0, -back), start.turn)
        things += house(kit, spot, width, 8.0)
        done += width + float(rng.choice([0.0, 0.0, 0.0, 2.0]))
    return things


def somewhere(rng: np.random.Generator, x: float, near: float, far: float) -> Spot:
    """Return a spot within x of the middle that faces anywhere."""
    foot = (float(rng.uniform(-x, x)), 0.0, float(rng.uniform(near, far)))
    return Spot(foot, float(rng.uniform(0.0, 360.0)))


def standing(kit: Kit, spot: Spot) -> list[Thing]:
    """Return a person, some clutter or a tree."""
    makers = furniture.person, furniture.clutter, furniture.tree
    return makers[kit.rng.choice(len(makers), p=STANDING)](kit, spot)


def street(kit: Kit) -> tuple[list[Thing], View]:
    """Return a street between two rows of houses, which a house may end."""
    rng = kit.rng
    road, walk = float(rng.uniform(2.8, 5.0)), float(rng.uniform(1.8, 3.2))
    wall, far = road + walk, float(rng.uniform(28.0, 50.0))
    things = [ground()]
    length = far - BEHIND
    for side in (-1, 1):
        # A row goes on to the right of its fronts: on the left side away, else back.
        start = BEHIND if side > 0 else far
        things += row(kit, Spot((side * wall, 0.0, start), -90.0 * side), length)
        centre = (side * (road + walk / 2), KERB / 2, far / 2)
        things.append(Thing("box", centre, (walk, KERB, far + 40.0), PAVING))
    if rng.random() < 0.75:
        things += row(kit, Spot((wall + 2.0, 0.0, far), 180.0), 2 * wall + 4.0)
    things += street_lamps(kit, road, far)
    things += traffic(kit, road, far)
    for _ in range(int(rng.integers(3, 11))):
        aside = float(rng.choice([-1.0, 1.0])) * (
            road + 0.6 + rng.random() * (walk - 1)
        )
        spot = Spot((aside, KERB, float(rng.uniform(3.0, 22.0))), rng.uniform(0, 360))
        things += standing(kit, spot)
    if rng.random() < 0.3:
        for z in (6.0, 11.0, 17.0):
            things += furniture.festoon(kit, Spot((-wall, 0.0, z)), 2 * wall, 6.0)
    return things, view(rng, road * 0.8)


def street_lamps(kit: Kit, road: float, far: float) -> list[Thing]:
    """Return lamps along a street, on one side or in turn."""
    rng = kit.rng
    kind, height = str(rng.choice(["globe", "hood"])), float(rng.uniform(4.0, 7.0))
    pitch, alternate = float(rng.uniform(9.0, 16.0)), bool(rng.random() < 0.6)
    side, things = float(rng.choice([-1.0, 1.0])), list[Thing]()
    for z in np.arange(float(rng.uniform(-6.0, 3.0)), far, pitch):
        spot = Spot((side * (road + 0.5), 0.0, float(z)), -90.0 * side)
        if rng.random() < 0.9:  # else it is broken
            things += furniture.street_lamp(kit, spot, kind, height)
        side = -side if alternate else side
    return things


def traffic(kit: Kit, road: float, far: float) -> list[Thing]:
    """Return cars at the kerb and, in some streets, on the road."""
    rng, things = kit.rng, list[Thing]()
    parked = float(rng.uniform(0.1, 0.7))
    for side in (-1, 1):
        for z in np.arange(float(rng.uniform(5.0, 9.0)), far - 6.0, 5.5):
            if rng.random() < parked:
                foot = (side * (road - 0.95), 0.0, float(z))
                turn = 0.0 if rng.random() < 0.7 else 180.0
                things += furniture.car(kit, Spot(foot, turn), driving=False)
    for side in (-1, 1):
        if rng.random() < 0.4:
            foot = (side * 0.4 * (road - 1.9), 0.0, float(rng.uniform(9.0, 26.0)))
            spot = Spot(foot, 0.0 if side > 0 else 180.0)
            things += furniture.car(kit, spot, driving=True)
    return things


def square(kit: Kit) -> tuple[list[Thing], View]:
    """Return a square with houses on three sides, a market or a fountain."""
    rng = kit.rng
    half, far = float(rng.uniform(9.0, 15.0)), float(rng.uniform(18.0, 32.0))
    things = [ground(), *paving(rng, half, far)]
    for side in (-1, 1):
        start = BEHIND if side > 0 else far
        spot = Spot((side * half, 0.0, start), -90.0 * side)
        things += row(kit, spot, far - BEHIND)
    things += row(kit, Spot((half + 4.0, 0.0, far), 180.0), 2 * half + 8.0)
    kind, height = str(rng.choice(["globe", "hood"])), float(rng.uniform(3.6, 6.5))
    behind = Spot((float(rng.uniform(-5.0, 5.0)), 0.0, -3.0))
    spots = [
        somewhere(rng, half - 2.0, 6.0, far - 3.0) for _ in range(rng.integers(2, 6))
    ]
    for spot in [behind, *spots]:
        things += furniture.street_lamp(kit, spot, kind, height)
    if rng.random() < 0.5:
        centre = (float(rng.uniform(-3.0, 3.0)), 0.0, float(rng.uniform(9.0, 14.0)))
        things += furniture.fountain(kit, Spot(centre))
    for place in range(int(rng.integers(0, 6))):
        across = (-1) ** place * float(rng.uniform(2.5, half - 2.5))
        spot = Spot((across, 0.0, 7.0 + 2.2 * place), float(rng.uniform(150, 210)))
        things += furniture.stall(kit, spot)
    for _ in range(int(rng.integers(5, 16))):
        things += standing(kit, somewhere(rng, half - 1.5, 5.0, far - 3.0))
    if rng.random() < 0.3:
        spot = somewhere(rng, half - 3.0, 10.0, far - 4.0)
        things += furniture.car(kit, spot, driving=False)
    if rng.random() < 0.3:
        for z in (7.0, 12.0):
            spot = Spot((-half, 0.0, z))
            things += furniture.festoon(kit, spot, 2 * half, 6.5)
    return things, view(rng, half * 0.3)


def paving(rng: np.random.Generator, half: float, far: float) -> list[Thing]:
    """Return strips of paving on the ground of a square."""
    things, pitch = list[Thing](), float(rng.uniform(2.0, 5.0))
    for z in np.arange(BEHIND, far, pitch):
        place = (0.0, 0.005, float(z))
        size = (2 * half, 0.01, pitch * float(rng.uniform(0.2, 0.6)))
        things.append(Thing("box", place, size, PAVING))
    return things


PLANS = {"street": street, "square": square}
