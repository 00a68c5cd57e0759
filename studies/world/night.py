# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scenes by night: several lamps near the leaves, each of its own colour."""

import numpy as np

from studies.protocol import NightRules, Protocol
from studies.world.colorimetry import Array
from studies.world.day import common_one
from studies.world.leaves import scatter
from studies.world.materials import palette
from studies.world.scene import Scene
from studies.world.texture import texture

FALL_OFF = 1.5  # power of the squared distance: of a lamp over a matt plane


def night_scene(rng: np.random.Generator, measured: Array, protocol: Protocol) -> Scene:
    """Return a scene of two lights or more, of measured reflectances (n, 81)."""
    rules, night = protocol.scene, protocol.night
    count = int(rng.integers(rules.materials[0], rules.materials[1] + 1))
    materials = palette(rng, measured, count, protocol.materials)
    leaves = scatter(rng, count, rules)
    down, across = np.mgrid[: rules.height, : rules.width] / rules.height
    lights = int(rng.integers(night.lights[0], night.lights[1] + 1))
    shades = np.stack([pool(rng, down, across, night) for _ in range(lights)])
    emission = lamps(rng, down, across, night, lights)
    shades = shades * leaves.facing * (emission.sum(axis=0) == 0.0)
    dim = 0.6 + 0.4 * np.tanh(texture(rng, (rules.height, rules.width), 1.5))
    bounce = rng.uniform(*rules.bounce) * dim
    return Scene(materials, leaves, shades, emission, bounce, common_one(rng, leaves))


def pool(
    rng: np.random.Generator, down: Array, across: Array, night: NightRules
) -> Array:
    """Return the pool of light (H, W) under a lamp, at most 1."""
    row, column = rng.uniform(-0.2, 1.0), rng.uniform(-0.2, across.max() + 0.2)
    height = rng.uniform(*night.distance)
    squared = (down - row) ** 2 + (across - column) ** 2 + height**2
    fall_off = (height**2 / squared) ** FALL_OFF
    return np.asarray(rng.uniform(0.3, 1.0) * fall_off)


def lamps(
    rng: np.random.Generator,
    down: Array,
    across: Array,
    night: NightRules,
    lights: int,
) -> Array:
    """Return lamps in the frame (lights, H, W), each of one of the lights."""
    emission = np.zeros((lights, *down.shape))
    for _ in range(rng.integers(night.lamps[0], night.lamps[1] + 1)):
        row, column = rng.uniform(0.0, 0.7), rng.uniform(0.0, across.max())
        radius = rng.uniform(*night.lamp_radius)
        inside = (down - row) ** 2 + (across - column) ** 2 < radius**2
        emission[:, inside] = 0.0
        emission[rng.integers(lights), inside] = rng.uniform(*night.lamp_level)
    return emission
