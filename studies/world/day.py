# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scenes by day or in a room: a main light, and one that fills its shadows."""

import numpy as np

from studies.protocol import DayRules, Protocol
from studies.world.colorimetry import Array
from studies.world.leaves import Leaves, scatter
from studies.world.materials import palette
from studies.world.scene import Scene
from studies.world.texture import texture

UNEVEN = 0.3  # log sd of a light over the frame
SMOOTH, SHADOW = 2.2, 2.0  # powers of the textures of light and of shadows


def day_scene(rng: np.random.Generator, measured: Array, protocol: Protocol) -> Scene:
    """Return a scene of two lights, of measured reflectances (n, 81)."""
    rules, day = protocol.scene, protocol.day
    count = int(rng.integers(rules.materials[0], rules.materials[1] + 1))
    materials = palette(rng, measured, count, protocol.materials)
    leaves = scatter(rng, count, rules)
    shape = leaves.mix.shape
    main = shadows(rng, shape, day) * uneven(rng, shape)
    second = rng.uniform(*day.second) * uneven(rng, shape)
    shades = np.stack([main, second]) * leaves.facing
    emission = np.stack([np.zeros(shape), sky(rng, shape, day)])
    shades *= emission[1] == 0.0  # the sky hides the leaves
    emission[0] = highlights(rng, shades[0], day)
    bounce = rng.uniform(*rules.bounce) * (
        0.6 + 0.4 * np.tanh(texture(rng, shape, 1.5))
    )
    return Scene(materials, leaves, shades, emission, bounce, common_one(rng, leaves))


def common_one(rng: np.random.Generator, leaves: Leaves) -> int:
    """Return a material, each as likely as it is common."""
    return int(rng.choice(len(leaves.common), p=leaves.common))


def uneven(rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
    """Return how a light varies over the frame (H, W), around 1."""
    height, width = shape
    return np.asarray(np.exp(UNEVEN * texture(rng, (height, width), SMOOTH)))


def shadows(rng: np.random.Generator, shape: tuple[int, ...], day: DayRules) -> Array:
    """Return (H, W), 0 in cast shadows and 1 out of them; 1 in a scene without."""
    height, width = shape
    edge = rng.uniform(2.0, 20.0) * (
        texture(rng, (height, width), SHADOW) + rng.uniform(-0.3, 1.3)
    )
    if rng.random() >= day.shadows:
        return np.ones(shape)
    return np.asarray(0.5 + 0.5 * np.tanh(edge))


def highlights(rng: np.random.Generator, main: Array, day: DayRules) -> Array:
    """Return the main light's mirror images (H, W), 0 in a scene without gloss.

    main : (H, W), how much of it falls on the leaves."""
    height, width = main.shape
    rarity = rng.uniform(*day.gloss_rarity)
    shining = texture(rng, (height, width), 0.8) > rarity
    level = (rng.random() < day.gloss) * rng.uniform(*day.gloss_level)
    return np.asarray(level * shining * main)


def sky(rng: np.random.Generator, shape: tuple[int, ...], day: DayRules) -> Array:
    """Return the second light seen itself (H, W), at the top; 0 in a scene without."""
    height, width = shape
    skyline = texture(rng, (2, width), 1.2)[0]
    edge = rng.uniform(*day.sky_height) + 0.04 * skyline
    above = np.arange(height)[:, None] / height < edge
    clouds = np.exp(0.12 * texture(rng, (height, width), SHADOW))
    level = (rng.random() < day.sky) * rng.uniform(*day.sky_level)
    return np.asarray(level * above * clouds)
