# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands by the water at night: quays, canals, bridges, harbours."""

import math

from . import crowd, draws, floor, houses
from .colour import neon_rgb
from .description import Camera, Scene

LAYOUTS = (
    "quay",
    "canal",
    "arch bridge",
    "on the bridge",
    "suspension bridge",
    "harbour",
    "marina",
    "wheel",
)
WATER = -1.6  # m, its level below the quay
EDGE = 3.0  # m, the end of the near quay
CANAL, BANK = 5.5, 9.5  # half widths in m of a canal's water and of its houses
DECK, PARAPET = 4.5, 6.3  # half widths in m of a bridge's road and of its deck


def camera(index, layout):
    """Draw where the picture is taken, along the water or across."""
    rng = draws.stream(index, "camera")
    height = rng.choice((1.6, 1.6, 1.2, 2.6, 5.5))
    if layout == "canal":
        x = rng.choice((0.0, rng.uniform(-1, 1) * (BANK - 1.5)))
        height = max(height, 2.4) if abs(x) < CANAL else min(height, 2.4)
        target = (rng.uniform(-3, 3), 26.0, rng.uniform(0.0, 3.5))
        return Camera((x, -2.0, height), target, rng.choice((20, 24, 28, 35)))
    if layout == "on the bridge":
        x = rng.uniform(-1, 1) * (PARAPET - 0.8)
        target = (rng.uniform(-8, 8), 30.0, rng.uniform(1.5, 4.5))
        return Camera((x, -2.0, height), target, rng.choice((20, 24, 28, 35)))
    turn = rng.uniform(-0.5, 0.5)
    x, y = rng.uniform(-6, 6), rng.uniform(-7, -2.5)
    target = (x + 40 * math.sin(turn), y + 40 * math.cos(turn), rng.uniform(0.5, 5.0))
    return Camera((x, y, height), target, rng.choice((20, 24, 28, 35, 50)))


def quay_lamps(rng, ground):
    """Draw lamp posts along the near edge, their heads over the quay."""
    light, found = draws.white(rng), []
    step, x = rng.uniform(8, 14), -42 + rng.uniform(0, 8)
    while x < 42:
        spot = (x, EDGE - 0.9)
        if ground.take(floor.of("pole", *spot), 0.1):
            power = rng.uniform(120, 240)
            found.append(draws.lamp(rng, "post", (*spot, 0.0), 0.0, light, power))
        x += step
    return found


def far_lamps(rng, y):
    """Draw lamps along the far bank: they are what the water mirrors."""
    light, found = draws.white(rng), []
    other = draws.white(rng)
    step, x = rng.uniform(7, 12), -62.0
    while x < 62:
        which = light if rng.random() < 0.75 else other
        power = rng.uniform(300, 600)
        found.append(draws.lamp(rng, "post", (x, y, 0.0), 0.0, which, power, 1.6))
        x += step
    return found


def boats(rng, ground, layout):
    """Draw boats on the water, moored or on their way."""
    count = {"marina": 14, "harbour": 5, "canal": 5}.get(layout, rng.randint(0, 4))
    tall = rng.uniform(6, 10) if layout == "marina" else rng.uniform(0, 5)
    size = (2.4, 7.0, tall)
    area = (-24, 24, EDGE + 5.0, 34.0)
    if layout == "canal":
        size, area = (1.9, 5.5, 0.0), (-CANAL + 1.4, CANAL - 1.4, 5.0, 40.0)
    found = []
    for boat in crowd.scatter(
        rng, ground, "boat", count, area, size, (0.5, 0.5, 0.48), False, WATER
    ):
        found.append(draws.repainted(boat, rng.choice(draws.PAINTS)))
    return found


def sights(rng, ground, layout, far):
    """Draw what the layout is named for."""
    grey, steel = (0.30, 0.27, 0.23), (0.10, 0.11, 0.12)
    hue = neon_rgb(rng.random(), 0.9)
    if layout in ("arch bridge", "suspension bridge"):
        name = layout.replace(" ", "_")
        y, turn = rng.uniform(26, 38), rng.uniform(-0.35, 0.35)
        return [draws.thing(rng, name, (0, y, WATER), turn, (130.0, 7.0, 7.0), grey)]
    if layout == "wheel":
        x = rng.uniform(-14, 14)
        size = (24.0, 3.0, 26.0)
        return [draws.thing(rng, "wheel", (x, far + 3, 0.0), 0.0, size, hue)]
    if layout == "harbour":
        found = []
        for x in (-26.0, -4.0, 20.0):
            spot = (x + rng.uniform(-4, 4), far + 4, 0.0)
            found.append(draws.thing(rng, "crane", spot, 0.0, (8.0, 8.0, 22.0), steel))
        for _ in range(16):
            x = rng.uniform(-40, 40)
            shade = rng.choice(draws.PAINTS)
            found += crowd.put(
                rng, ground, "container", x, far + 1.6, 0.0, (6.0, 2.4, 2.6), shade
            )
        return found
    return []


def promenade(rng, ground):
    """Draw benches, bollards, trees and bins of the near quay."""
    things = [draws.thing(rng, "rail", (0, EDGE - 0.25, 0), 0, (90, 0.1, 1.05))]
    area = (-22, 22, -1.5, EDGE - 1.4)
    for name, most, size, shade in (
        ("bench", 4, (1.8, 0.6, 0.85), (0.2, 0.11, 0.05)),
        ("bin", 2, (0.6, 0.6, 1.0), (0.04, 0.045, 0.05)),
        ("bicycle", 2, (0.5, 1.8, 1.0), (0.05, 0.05, 0.06)),
        ("tree", 2, (0.7, 0.7, rng.uniform(5, 7)), (0.05, 0.11, 0.03)),
    ):
        count = rng.randint(0, most)
        things += crowd.scatter(rng, ground, name, count, area, size, shade)
    return things


def across(index, layout, view, ground, weather):
    """Return the parts of a scene that looks over a river."""
    rng = draws.stream(index, "across")
    far = rng.uniform(42, 62)
    tall = (5, 12) if layout == "harbour" else rng.choice(((7, 18), (12, 40), (9, 26)))
    things = promenade(rng, ground) + sights(rng, ground, layout, far)
    things += boats(rng, ground, layout)
    lamps = quay_lamps(rng, ground) + far_lamps(rng, far + 1)
    area = (-16, 16, 0.0, EDGE - 0.8)
    people = crowd.people(
        rng, ground, rng.randint(2, 12), area, 0.0, weather.wet, view=view
    )
    people += crowd.seated(rng, things, 0.3, view)
    towers = houses.skyline(rng, -80, 80, far + 7, tall)
    signs = bank_signs(rng, towers)
    return {
        "stage": {"plan": "river", "far": far, "water": WATER},
        "things": tuple(things),
        "lamps": tuple(lamps),
        "people": tuple(people),
        "towers": tuple(towers),
        "signs": tuple(signs),
    }


def bank_signs(rng, towers):
    """Draw large letters on houses over the water, one a house at most."""
    found = []
    seen = [tower for tower in towers if abs(tower.place[0]) < 34]
    for tower in rng.sample(seen, min(len(seen), rng.randint(1, 5))):
        (x, y, _), (wide, deep, tall) = tower.place, tower.size
        size = min(rng.uniform(1.6, 2.8), tall / 4)
        new = draws.sign(rng, "letters", (0, 0, 0), 0.0, size)
        long, high = draws.sign_size("letters", new.text, size)
        if long < wide - 0.5:
            z = rng.uniform(high, tall - high)
            found.append(draws.moved(new, (x, y - deep / 2, z)))
    return found


def canal(index, view, ground, weather):
    """Return the parts of a scene that looks along a canal."""
    rng = draws.stream(index, "canal")
    rows = tuple(
        houses.row(rng, (s * BANK, -9, 0), 0.0, s, 75.0, (3, 4, 4), 0.35)
        for s in (-1, 1)
    )
    things, lamps, people = boats(rng, ground, "canal"), [], []
    for side in (-1, 1):
        light, y = draws.white(rng), rng.uniform(3, 9)
        x = side * (CANAL + 0.5)
        while y < 60:
            if ground.take(floor.of("pole", x, y)):
                turn, power = -side * math.pi / 2, rng.uniform(120, 220)
                lamps.append(draws.lamp(rng, "post", (x, y, 0), turn, light, power))
            y += rng.uniform(9, 13)
        edge = sorted((side * (CANAL + 0.5), side * (BANK - 0.5)))
        area = (*edge, 4.0, 30.0)
        people += crowd.people(
            rng, ground, rng.randint(1, 5), area, 0, weather.wet, view=view
        )
        size, shade = (0.5, 1.8, 1.0), (0.05, 0.05, 0.06)
        things += crowd.scatter(
            rng, ground, "bicycle", rng.randint(1, 5), area, size, shade, False
        )
    y = rng.uniform(22, 40)
    size, grey = (2 * CANAL + 2.0, 3.0, 2.2), (0.25, 0.16, 0.11)
    things.append(draws.thing(rng, "arch", (0, y, WATER), 0.0, size, grey))
    strings = [
        draws.festoon(rng, (-BANK, y, 6.5), (BANK, y + 2, 6.2))
        for y in rng.sample((10.0, 16.0, 30.0), rng.randint(0, 2))
    ]
    return {
        "stage": {"plan": "canal", "canal": CANAL, "wall": BANK, "water": WATER},
        "rows": rows,
        "things": tuple(things),
        "lamps": tuple(lamps),
        "people": tuple(people),
        "festoons": tuple(strings),
        "towers": tuple(houses.skyline(rng, -40, 40, 74, (9, 22))),
    }


def deck(index, view, ground, weather):
    """Return the parts of a scene on a bridge's deck."""
    rng = draws.stream(index, "deck")
    lamps, vehicles, people = [], [], []
    for side in (-1, 1):
        light, y = draws.white(rng), rng.uniform(4, 12)
        while y < 90:
            if ground.take(floor.of("pole", side * (DECK + 0.4), y)):
                place, turn = (side * (DECK + 0.4), y, 0.13), -side * math.pi / 2
                power = rng.uniform(300, 520)
                lamps.append(draws.lamp(rng, "pole", place, turn, light, power))
            y += rng.uniform(16, 20)
        turn = math.pi if side > 0 else 0.0
        bodies = (*draws.CAR_BODIES, "bus")
        x = side * 2.1
        vehicles += crowd.lane(rng, ground, x, turn, (6, 80), (4, 18), 0.7, bodies)
        edge = sorted((side * (DECK + 0.3), side * (PARAPET - 0.3)))
        area = (*edge, 5.0, 34.0)
        count = rng.randint(1, 6)
        people += crowd.people(rng, ground, count, area, 0.13, weather.wet, view=view)
    things = [
        draws.thing(rng, "rail", (s * PARAPET, 45, 0.13), math.pi / 2, (120, 0.1, 1.1))
        for s in (-1, 1)
    ]
    banks = houses.skyline(rng, -90, -16, 80, (10, 34)) + houses.skyline(
        rng, 16, 90, 80, (10, 34)
    )
    return {
        "stage": {"plan": "deck", "deck": DECK, "parapet": PARAPET, "water": -7.0},
        "things": tuple(things),
        "lamps": tuple(lamps) + tuple(far_lamps(rng, 76.0)),
        "people": tuple(people),
        "vehicles": tuple(vehicles),
        "towers": (*banks, *houses.skyline(rng, -16, 16, 112, (12, 30))),
    }


def choose(index, layout):
    """Return the scene by the water called @layout in LAYOUTS."""
    ground = floor.Floor()
    view, weather = camera(index, layout), draws.weather(index)
    ground.keep_clear(view)
    if layout == "canal":
        parts = canal(index, view, ground, weather)
    elif layout == "on the bridge":
        parts = deck(index, view, ground, weather)
    else:
        parts = across(index, layout, view, ground, weather)
    return Scene(
        index=index,
        kind="waterfront",
        layout=layout,
        camera=view,
        sky=draws.sky(index),
        weather=weather,
        **parts,
    )
