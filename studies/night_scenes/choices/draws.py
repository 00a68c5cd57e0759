# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draws that all kinds of scenes share. A draw depends on index and purpose alone."""

import math
import random
from dataclasses import replace

from .colour import neon_rgb
from .description import (
    Festoon,
    Lamp,
    Person,
    Sign,
    Sky,
    Thing,
    Tower,
    Vehicle,
    Weather,
)

BAY, STOREY = 1.9, 3.1  # m, of distant houses
COOLEST, WARMEST = 6500.0, 2000.0  # K, of lamps

# Kelvin and Duv from-to, and how often each occurs. Own choice, to cover what stands in
# streets: high pressure sodium, bulbs, metal halide, LED, old tubes.
LAMPS = (
    ((2000, 2150), (0.000, 0.008), 30),
    ((2200, 2700), (-0.004, 0.006), 22),
    ((2700, 3100), (-0.004, 0.012), 22),
    ((3400, 4300), (-0.004, 0.015), 16),
    ((4800, 6500), (-0.004, 0.012), 10),
)
WORDS = (
    "HOTEL BAR CAFE 24H KINO TAXI SUSHI PHO JAZZ PIZZA CLUB RAMEN BOOKS OPEN GRILL "
    "DISCO TAPAS METRO APTEKA BINGO DINER MUSIC SAUNA TEA VINO KEBAB FILM PARK ROXY "
    "LUNA ARENA OPERA"
).split()
PAINTS = (
    (0.02, 0.02, 0.03),
    (0.30, 0.30, 0.31),
    (0.55, 0.55, 0.53),
    (0.30, 0.015, 0.012),
    (0.02, 0.06, 0.18),
    (0.02, 0.12, 0.06),
    (0.48, 0.30, 0.02),
    (0.10, 0.10, 0.11),
    (0.16, 0.24, 0.30),
)
CLOTHES = (
    (0.015, 0.015, 0.02),
    (0.03, 0.04, 0.09),
    (0.10, 0.07, 0.045),
    (0.16, 0.15, 0.14),
    (0.28, 0.03, 0.03),
    (0.05, 0.10, 0.06),
    (0.40, 0.37, 0.30),
    (0.42, 0.26, 0.03),
)
CAR_BODIES = ("hatchback", "saloon", "van")
WALKING = ("standing", "walking", "striding", "phone")


def stream(index, purpose):
    """Return the random numbers of one purpose in one scene."""
    return random.Random(f"night scene {index}: {purpose}")


def white(rng):
    """Draw a lamp's (kelvin, duv)."""
    kelvin, duv, _ = rng.choices(LAMPS, [share for *_, share in LAMPS])[0]
    return rng.uniform(*kelvin), rng.uniform(*duv)


def lamp(rng, name, place, turn, light, power, size=1.0):
    """Return a lamp of @light (kelvin, duv) that has aged a little."""
    kelvin = min(COOLEST, max(WARMEST, light[0] * rng.uniform(0.98, 1.02)))
    return Lamp(
        name, place, turn, kelvin, light[1], power * rng.uniform(0.85, 1.15), size
    )


def weather(index, indoors=False):
    """Draw rain or none; one scene in twenty outdoors has haze."""
    rng = stream(index, "weather")
    wet = 0.0 if rng.random() < 0.4 or indoors else rng.uniform(0.3, 1.0)
    haze = rng.uniform(0.004, 0.012) if rng.random() < 0.05 and not indoors else 0.0
    return Weather(wet, haze)


def sky(index):
    """Draw the hour: moonless under the town's glow, cloud, moon, blue hour or dusk."""
    rng = stream(index, "sky")
    name = rng.choice(("moonless", "glow", "cloud", "moon", "blue hour", "dusk"))
    level = rng.uniform(0.6, 1.6)
    horizon, zenith = {
        "moonless": ((0.0022, 0.0018, 0.0016), (0.0004, 0.0005, 0.0008)),
        "glow": ((0.020, 0.012, 0.006), (0.0024, 0.0022, 0.0026)),
        "cloud": ((0.016, 0.013, 0.011), (0.011, 0.008, 0.006)),
        "moon": ((0.006, 0.007, 0.009), (0.0018, 0.0024, 0.0042)),
        "blue hour": ((0.050, 0.058, 0.085), (0.010, 0.017, 0.042)),
        "dusk": ((0.22, 0.10, 0.045), (0.016, 0.022, 0.044)),
    }[name]
    around = rng.uniform(0, 2 * math.pi)
    rise = rng.uniform(0.35, 1.1)
    moon = rng.uniform(0.01, 0.03) if name == "moon" else 0.0
    return Sky(
        name,
        tuple(level * c for c in horizon),
        tuple(level * c for c in zenith),
        moon,
        (
            math.cos(around) * math.cos(rise),
            math.sin(around) * math.cos(rise),
            math.sin(rise),
        ),
    )


def hue(rng):
    """Draw (hue, saturation) of neon from the whole circle."""
    return rng.random(), rng.uniform(0.85, 1.0)


def sign_size(name, word, size):
    """Return (length, height) in metres of a sign whose letters are @size m high."""
    return {
        "letters": (0.8 * size * len(word), 1.4 * size),
        "blade": (1.2, 1.6 * size),
        "column": (1.2, 1.05 * size * len(word)),
        "ring": (1.6, 1.6),
        "screen": (3.6, 2.4),
    }[name]


def sign(rng, name, place, turn, size, radiance=None):
    """Draw a sign's word, hue and radiance."""
    word = rng.choice(WORDS)
    strength = rng.uniform(10, 32) if radiance is None else radiance
    return Sign(name, word, place, turn, *hue(rng), strength, size)


def festoon(rng, start, end, coloured=None):
    """Draw a string of bulbs: warm white, or of four hues."""
    coloured = rng.random() < 0.35 if coloured is None else coloured
    span = math.dist(start, end)
    if coloured:
        first = rng.random()
        colours = tuple(neon_rgb(first + step / 4, 0.92) for step in range(4))
    else:
        colours = ((1.0, 0.48, 0.14),)
    return Festoon(
        start, end, span * rng.uniform(0.05, 0.09), max(6, round(span / 1.1)), colours
    )


def vehicle(rng, body, place, turn, lit):
    """Draw a vehicle's paint."""
    return Vehicle(body, place, turn, rng.choice(PAINTS), lit)


def person(rng, pose, place, turn, umbrella=False):
    """Draw a figure's height and clothes."""
    return Person(
        pose,
        place,
        turn,
        rng.uniform(1.56, 1.90),
        rng.choice(CLOTHES),
        rng.choice(CLOTHES[:4]),
        umbrella,
    )


def thing(rng, name, place, turn=0.0, size=(1.0, 1.0, 1.0), shade=(0.2, 0.2, 0.2)):
    """Return a thing with a seed of its own."""
    return Thing(name, place, turn, size, shade, rng.randrange(10**6))


def whole_bays(wide, deep, tall):
    """Return a distant house's size with whole windows and storeys, and a parapet."""
    bays = [2 * BAY * max(1, round(length / (2 * BAY))) for length in (wide, deep)]
    return (*bays, STOREY * max(1, round(tall / STOREY)) + 0.5)


def tower(rng, place, size, lit=None):
    """Draw a distant house's colour and its windows; size as of whole_bays."""
    grey = rng.uniform(0.06, 0.30)
    shade = (grey, grey * rng.uniform(0.85, 1.0), grey * rng.uniform(0.7, 1.0))
    kelvin, _ = white(rng)
    share = rng.uniform(0.08, 0.45) if lit is None else lit
    seed = rng.randrange(1000)
    return Tower(place, size, shade, share, kelvin, rng.uniform(0.4, 1.6), seed)


def moved(item, place):
    """Return the same sign or thing at another place."""
    return replace(item, place=place)


def repainted(item, shade):
    """Return the same thing in another colour."""
    return replace(item, shade=shade)
