# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands in streets and squares: lamps, cars, people, trees, stalls."""

import math

import numpy as np

from studies.mitsuba_judge.kit import Kit
from studies.mitsuba_judge.spectra import GLASS, POLE
from studies.mitsuba_judge.things import Spot, Thing

GLOBE = 0.14  # m, radius
HOOD = (0.5, 0.06, 0.22)  # m
BULB = 0.06  # m, radius


def street_lamp(kit: Kit, spot: Spot, kind: str, height: float) -> list[Thing]:
    """Return a lamp (globe or hood) that reaches forward over the road."""
    rng, light = kit.rng, kit.lamp()
    level = kit.level(1.0, 0.3)
    reach = 0.0 if kind == "globe" else float(rng.uniform(0.8, 1.6))
    pole = spot.rod((0.0, 0.0, 0.0), 0.07, height, POLE)
    if kind == "globe":
        power = level * (height / GLOBE) ** 2
        place = (0.0, height + GLOBE, 0.0)
        return [pole, spot.shining("ball", place, (GLOBE,), light, power)]
    power = level * math.pi * height**2 / (HOOD[0] * HOOD[2])
    return [
        pole,
        spot.box((0.0, height, reach / 2), (0.08, 0.08, reach), POLE),
        spot.box((0.0, height, reach), (0.7, 0.1, 0.4), POLE),
        spot.shining("box", (0.0, height - 0.08, reach), HOOD, light, power),
    ]


def car(kit: Kit, spot: Spot, driving: bool) -> list[Thing]:
    """Return a car whose front is forward; its lamps are lit if it is driving."""
    paint = kit.paint()
    things = [
        spot.box((0.0, 0.62, 0.0), (1.75, 0.55, 4.2), paint),
        spot.box((0.0, 1.13, -0.2), (1.5, 0.5, 2.2), GLASS),
        spot.box((0.0, 1.4, -0.2), (1.45, 0.06, 1.9), paint),
        spot.box((0.0, 0.25, 0.0), (1.6, 0.3, 3.6), POLE),
    ]
    if not driving:
        return things
    front, tail = kit.any_lamp(), kit.level(3.0, 0.4)
    back = Spot(spot.at(0.0, 0.0, -2.12), spot.turn + 180.0)
    for across in (-0.65, 0.65):
        place, size, level = (across, 0.68, 2.12), (0.22, 0.13), kit.level(15.0, 0.3)
        things.append(spot.shining("panel", place, size, front, level))
        place, size = (across, 0.72, 0.0), (0.25, 0.14)
        things.append(back.shining("panel", place, size, kit.spectra.red, tail))
    return things


def person(kit: Kit, spot: Spot) -> list[Thing]:
    """Return somebody who stands."""
    coat, trousers, head = (kit.paint() for _ in range(3))
    scale = float(kit.rng.uniform(0.9, 1.08))
    return [
        spot.rod((0.0, 0.0, 0.0), 0.13, 0.85 * scale, trousers),
        spot.rod((0.0, 0.75 * scale, 0.0), 0.2, 0.65 * scale, coat),
        spot.ball((0.0, 1.4 * scale, 0.0), 0.22, coat),
        spot.ball((0.0, 1.68 * scale, 0.0), 0.12, head),
    ]


def tree(kit: Kit, spot: Spot) -> list[Thing]:
    """Return a trunk and a crown of balls."""
    rng, leaves = kit.rng, kit.paint()
    tall = float(rng.uniform(2.2, 4.0))
    things = [spot.rod((0.0, 0.0, 0.0), 0.15, tall, kit.paint())]
    for _ in range(int(rng.integers(2, 6))):
        across, up, forward = rng.uniform(-0.7, 0.7, 3)
        place = (float(across), tall + 0.5 + float(up), float(forward))
        things.append(spot.ball(place, float(rng.uniform(0.6, 1.3)), leaves))
    return things


def stall(kit: Kit, spot: Spot) -> list[Thing]:
    """Return a market stall with goods under a bulb; its front is open."""
    rng, roof, table = kit.rng, kit.paint(), kit.paint()
    things = [
        spot.box((0.0, 2.5, 0.0), (3.2, 0.12, 2.2), roof),
        spot.box((0.0, 0.45, 0.0), (2.8, 0.9, 1.4), table),
        spot.panel((0.0, 1.6, -1.0), (3.0, 1.7), kit.paint()),
    ]
    for across in (-1.5, 1.5):
        for forward in (-1.0, 1.0):
            things.append(spot.rod((across, 0.0, forward), 0.04, 2.5, POLE))
    for across in np.arange(-1.2, 1.3, 0.4):
        goods = kit.paint()
        for forward in (-0.3, 0.1, 0.5):
            place = (float(across), 1.0, forward)
            if rng.random() < 0.5:
                things.append(spot.ball(place, 0.16, goods))
            else:
                things.append(spot.box(place, (0.3, 0.24, 0.3), goods))
    level = kit.level(1.0, 0.4) * (1.1 / BULB) ** 2
    bulb = spot.shining("ball", (0.0, 2.0, 0.3), (BULB,), kit.any_lamp(), level)
    return [*things, bulb]


def fountain(kit: Kit, spot: Spot) -> list[Thing]:
    """Return a basin with water, a column and a ball."""
    stone, side = kit.paint(), float(kit.rng.uniform(2.5, 4.5))
    things = [spot.box((0.0, 0.36, 0.0), (side - 0.5, 0.1, side - 0.5), GLASS)]
    for across, forward in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        long = (0.3, 0.5, side) if across else (side, 0.5, 0.3)
        place = (across * side / 2, 0.25, forward * side / 2)
        things.append(spot.box(place, long, stone))
    things.append(spot.rod((0.0, 0.0, 0.0), 0.3, 2.0, stone))
    return [*things, spot.ball((0.0, 2.3, 0.0), 0.5, kit.paint())]


def clutter(kit: Kit, spot: Spot) -> list[Thing]:
    """Return a crate, a bin or a bollard, or a few of them."""
    rng, things = kit.rng, []
    for _ in range(int(rng.integers(1, 4))):
        across, forward = (float(x) for x in rng.uniform(-0.8, 0.8, 2))
        if rng.random() < 0.3:
            things.append(spot.rod((across, 0.0, forward), 0.12, 0.9, kit.paint()))
            things.append(spot.ball((across, 0.9, forward), 0.14, kit.paint()))
        else:
            wide, tall = (float(x) for x in rng.uniform(0.3, 0.9, 2))
            size = (wide, tall, wide)
            things.append(spot.box((across, tall / 2, forward), size, kit.paint()))
    return things


def festoon(kit: Kit, start: Spot, width: float, height: float) -> list[Thing]:
    """Return a string of bulbs across, sagging, from @start to its right."""
    light, level = kit.any_lamp(), kit.level(6.0, 0.4)
    things = []
    for share in np.linspace(0.1, 0.9, 9):  # away from the walls
        sag = 1.2 * (1.0 - (2.0 * share - 1.0) ** 2)
        place = (float(share) * width, height - float(sag), 0.0)
        things.append(start.shining("ball", place, (0.07,), light, level))
    return things
