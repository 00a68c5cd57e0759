# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds things by their names. Each module's THINGS has its own."""

from . import (
    home_things,
    room_things,
    shop_things,
    square_things,
    street_things,
    water_things,
)
from .library import group

THINGS = (
    street_things.THINGS
    | square_things.THINGS
    | water_things.THINGS
    | home_things.THINGS
    | room_things.THINGS
    | shop_things.THINGS
)


def build(things):
    """Build all things of a scene: at the origin, facing -y, then moved."""
    for thing in things:
        with group(thing.place, thing.turn):
            THINGS[thing.name](thing)
