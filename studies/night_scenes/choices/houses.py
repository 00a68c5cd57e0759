# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rows of houses and skylines."""

from . import draws
from .description import House, Row

# Kind of wall and its reflectance.
WALLS = (
    ("brick", (0.28, 0.085, 0.05)),
    ("brick", (0.20, 0.15, 0.11)),
    ("brick", (0.30, 0.20, 0.12)),
    ("stucco", (0.42, 0.36, 0.25)),
    ("stucco", (0.34, 0.35, 0.36)),
    ("stucco", (0.40, 0.22, 0.14)),
    ("stucco", (0.46, 0.42, 0.22)),
    ("stucco", (0.22, 0.28, 0.34)),
    ("stucco", (0.30, 0.36, 0.26)),
)


PLINTH = 0.13  # m; the facades' shops begin that high, where a pavement ends


def row(rng, place, turn, side, length, storeys, shops, gap=0.0):
    """Draw a row of houses @length metres long; place : its start on its pavement.

    storeys : to choose from; shops : share of ground floors with a lit shop;
    gap : metres between houses."""
    houses, y, before = [], 0.0, None
    while y < length - 6.0:
        end = min(length, y + rng.uniform(7.5, 12.5))
        wall = rng.choice([each for each in WALLS if each != before])
        before = wall
        shade = tuple(min(0.55, c * rng.uniform(0.75, 1.25)) for c in wall[1])
        kelvin, _ = draws.white(rng)
        lit = rng.random() < shops
        power = rng.uniform(40, 100)
        houses.append(
            House(y, end, rng.choice(storeys), wall[0], shade, lit, kelvin, power)
        )
        y = end + gap * rng.uniform(0.7, 1.4)
    return Row((*place[:2], place[2] - PLINTH), turn, side, tuple(houses))


def skyline(rng, x0, x1, y, heights, gaps=(0.0, 6.0), lit=None):
    """Draw towers side by side from @x0 to @x1, their fronts near @y."""
    towers, x = [], x0
    while x < x1:
        wide, tall = rng.uniform(9, 20), rng.uniform(*heights)
        wide, deep, tall = draws.whole_bays(wide, rng.uniform(8, 14), tall)
        place = (x + wide / 2, y + deep / 2 + rng.uniform(0, 6), 0.0)
        towers.append(draws.tower(rng, place, (wide, deep, tall), lit))
        x += wide + rng.uniform(*gaps)
    return towers
