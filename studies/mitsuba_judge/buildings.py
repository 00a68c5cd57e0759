# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Houses, with shops in some, and what hangs on their walls."""

import numpy as np

from studies.mitsuba_judge.kit import Kit
from studies.mitsuba_judge.spectra import GLASS
from studies.mitsuba_judge.things import Spot, Thing

WINDOW = (1.1, 1.5)  # m, width and height
STOREY, BAY = 3.1, 2.6  # m from window to window
FIRST_STOREY = 4.6  # m, middle of the lowest windows above a shop


def house(kit: Kit, spot: Spot, width: float, depth: float) -> list[Thing]:
    """Return a house whose front is in the middle of @spot."""
    rng = kit.rng
    height = float(rng.uniform(5.5, 15.0))
    wall, trim = kit.paint(), kit.paint()
    things = [
        spot.box((0.0, height / 2, -depth / 2), (width, height, depth), wall),
        spot.box((0.0, 0.35, 0.03), (width, 0.7, 0.06), trim),
        spot.box((0.0, height, 0.1), (width, 0.3, 0.5), trim),
    ]
    for up in np.arange(FIRST_STOREY, height - 1.2, STOREY):
        for across in bays(width):
            things += window(kit, spot, across, float(up), trim)
    if rng.random() < 0.45 and width > 4.0:
        return things + shop(kit, spot, width)
    for across in bays(width):
        if rng.random() < 0.3:
            door = kit.paint()
            things.append(spot.panel((across, 1.05, 0.07), (1.1, 2.1), door))
        else:
            things += window(kit, spot, across, 1.7, trim)
    if rng.random() < 0.4:
        across = float(rng.uniform(-0.3, 0.3)) * width
        things.append(spot.panel((across, 3.1, 0.02), (1.6, 0.9), kit.paint()))
    return things


def bays(width: float) -> list[float]:
    """Return where windows are, from the middle of a front."""
    count = max(1, int(width / BAY))
    return [(i - (count - 1) / 2) * width / count for i in range(count)]


def window(kit: Kit, spot: Spot, across: float, up: float, sill: int) -> list[Thing]:
    """Return a window, lit in some, with a bar and a sill."""
    wide, tall = WINDOW
    place = (across, up, 0.02)
    if kit.rng.random() < kit.lit:
        light, level = kit.any_lamp(), kit.level(0.45, 0.7)
        pane = spot.shining("panel", place, WINDOW, light, level)
    else:
        pane = spot.panel(place, WINDOW, GLASS)
    return [
        pane,
        spot.box((across, up, 0.04), (0.07, tall, 0.04), sill),
        spot.box((across, up - tall / 2, 0.1), (wide + 0.2, 0.08, 0.2), sill),
    ]


def shop(kit: Kit, spot: Spot, width: float) -> list[Thing]:
    """Return a lit shop window with goods before it; with sign and awning in some."""
    rng, wide = kit.rng, 0.75 * width
    light = kit.any_lamp()
    things = [
        spot.shining("panel", (0.0, 1.6, 0.07), (wide, 2.0), light, kit.level(0.7, 0.5))
    ]
    for across in np.arange(-wide / 2, wide / 2 + 0.1, wide / 3):
        things.append(
            spot.box((float(across), 1.6, 0.1), (0.1, 2.0, 0.08), kit.paint())
        )
    for _ in range(int(rng.integers(2, 7))):
        size = rng.uniform(0.2, 0.6, 3)
        across = float(rng.uniform(-wide / 2, wide / 2))
        place = (across, 0.6 + size[1] / 2, 0.35)
        things.append(spot.box(place, (size[0], size[1], 0.4), kit.paint()))
    if rng.random() < 0.75:
        things += sign(kit, spot, float(rng.uniform(0.3, 0.8)) * wide)
    if rng.random() < 0.5:
        things.append(spot.box((0.0, 2.75, 0.8), (wide, 0.1, 1.5), kit.paint()))
    return things


def sign(kit: Kit, spot: Spot, width: float) -> list[Thing]:
    """Return a lit sign on its board, flat on the wall."""
    tall, level = float(kit.rng.uniform(0.25, 0.6)), kit.level(0.9, 0.5)
    board = spot.box((0.0, 3.2, 0.08), (width + 0.4, tall + 0.3, 0.1), kit.paint())
    lit = (width, tall, 0.06)
    return [board, spot.shining("box", (0.0, 3.2, 0.18), lit, kit.sign(), level)]
