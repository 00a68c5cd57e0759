# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The world, and shots taken in it: scenes of a half under lights of that half."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from studies.protocol import PROTOCOL, LightRules, Protocol
from studies.world.colorimetry import Array, observer
from studies.world.day import day_scene
from studies.world.halves import HALVES, Half, generator
from studies.world.lights import FAMILIES, Lights, lights
from studies.world.night import night_scene
from studies.world.reflectances import reflectances
from studies.world.scene import Shot

SCENE, SECOND, MAIN, NIGHT = 11, 21, 31, 41  # keys of generators
KINDS = ("day", "night")  # one main light and a second, or mixed lamps
OUTDOORS = 0.7  # Z over Y of a main light above which the second is the sky: 4000 K
SPILL = 0.35  # most difference in Z over Y of two lamps in a room


@dataclass(frozen=True)
class GreyCards:
    """Neutrals (n, 3), G = 1, of grey cards, and who saw them (81, 3)."""

    neutrals: Array
    sensitivities: Array


@dataclass(frozen=True)
class World:
    """All spectra, each in one half."""

    reflectances: dict[Half, Array]
    lights: dict[Half, Lights]
    protocol: Protocol = PROTOCOL

    def hashes(self) -> dict[str, str]:
        """Return what tells two worlds apart."""
        parts = {
            "reflectances": [self.reflectances[half] for half in HALVES],
            "lights": [self.lights[half].powers for half in HALVES],
        }
        return {name: array_hash(arrays) for name, arrays in parts.items()}


def lit_by(world: World, leds: bool) -> World:
    """Return the world whose lights are LEDs alone, or all others."""
    pools = {half: p.chosen(p.led == leds) for half, p in world.lights.items()}
    return replace(world, lights=pools)


def load_world(luxpy: Path | None, protocol: Protocol = PROTOCOL) -> World:
    """Return the World of luxpy's data files, or of colour-science's alone."""
    return World(reflectances(luxpy), lights(luxpy, protocol.lights), protocol)


def array_hash(arrays: Iterable[Array]) -> str:
    """Return the hash of arrays to 9 digits, which machines agree on."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(",".join(f"{value:.9g}" for value in array.flat).encode())
    return digest.hexdigest()[:16]


def neutrals(powers: Array, sensitivities: Array) -> Array:
    """Return (n, 3), G = 1, of lights (n, 81) seen by sensitivities (81, 3)."""
    response = powers @ sensitivities
    return np.asarray(response / response[:, 1:2])


def card_weights(pool: Lights, cards: GreyCards, rules: LightRules) -> Array:
    """Return weights (n,), sum 1, by which lights are as warm or blue as grey cards.

    Over log R/B the weighted pool has the cards' density; how green lights are is left
    to the pool."""
    from scipy.stats import gaussian_kde

    def warmth(rgb: Array) -> Array:
        return np.asarray(np.log(rgb[:, 0] / rgb[:, 2]))

    share = pool.weights(rules.shares)
    found, goal = (
        warmth(neutrals(pool.powers, cards.sensitivities)),
        warmth(cards.neutrals),
    )
    wanted = gaussian_kde(goal, rules.card_bandwidth)(found)
    there = gaussian_kde(found, rules.pool_bandwidth, weights=share)(found)
    weight = share * wanted / (there + 1e-3)
    return np.asarray(weight / weight.sum())


def card_lights(
    world: World, half: Half, cards: GreyCards, count: int, seed: int = 0
) -> Array:
    """Return main lights (count, 81) of a half, as often as grey cards met them."""
    pool = world.lights[half]
    weight = card_weights(pool, cards, world.protocol.lights)
    chosen = generator(half, seed, MAIN).choice(len(pool.powers), count, p=weight)
    return pool.powers[chosen]


def second_light(rng: np.random.Generator, pool: Lights, main: Array) -> Array:
    """Return (81,): the sky beside daylight, or another lamp's spill beside a lamp."""
    own, others = float(main @ observer()[:, 2]), pool.blueness()
    if own > OUTDOORS:
        fit = (pool.family == FAMILIES.index("daylight")) & (others > own)
    else:
        fit = np.abs(others - own) < SPILL
    if not fit.any():
        return main
    return np.asarray(pool.powers[rng.choice(np.flatnonzero(fit))])


def day_shots(world: World, half: Half, first: int, mains: Array) -> list[Shot]:
    """Return a Shot for each main light (n, 81), of the scenes first, first + 1, ..."""
    shots = []
    for seed, main in enumerate(mains, first):
        scene_rng, light_rng = (generator(half, seed, key) for key in (SCENE, SECOND))
        scene = day_scene(scene_rng, world.reflectances[half], world.protocol)
        second = second_light(light_rng, world.lights[half], main)
        shots.append(Shot(scene, np.stack([main, second])))
    return shots


def night_shots(world: World, half: Half, first: int, count: int) -> list[Shot]:
    """Return Shots of the night scenes first, first + 1, ... under mixed lamps."""
    pool, shots = world.lights[half], []
    weight = pool.night_weights(world.protocol.lights)
    for seed in range(first, first + count):
        rng = generator(half, seed, NIGHT)
        scene = night_scene(rng, world.reflectances[half], world.protocol)
        chosen = rng.choice(len(pool.powers), len(scene.shades), p=weight)
        shots.append(Shot(scene, pool.powers[chosen]))
    return shots


def shots(
    world: World,
    half: Half,
    kind: str,
    cards: GreyCards,
    first: int,
    count: int,
    seed: int = 0,
) -> list[Shot]:
    """Return Shots of one of KINDS, of the scenes first, first + 1, ...

    Main lights of days are drawn by seed as often as grey cards met them."""
    if kind == "night":
        return night_shots(world, half, first, count)
    return day_shots(world, half, first, card_lights(world, half, cards, count, seed))
