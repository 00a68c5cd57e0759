# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dead leaves: which material each pixel shows, and how it faces the lights.

Source: A. B. Lee, D. Mumford and J. Huang, Int. J. Computer Vision 41, 2001."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.protocol import SceneRules
from studies.world.colorimetry import Array
from studies.world.texture import texture

TEXTURES = (0.8, 1.2, 1.8)  # powers of what mixes two materials
RADIUS_POWER = 0.8  # of a uniform number: a radius's density falls with its power 2.25
BUMPS = 0.35  # most log sd of a leaf's shading
CONTRAST = 1.5  # of a mixture


@dataclass(frozen=True)
class Leaves:
    """Maps (H, W) of a scene's surfaces."""

    first: NDArray[np.int64]  # material
    second: NDArray[np.int64]
    mix: Array  # share of the second material, 0..1
    facing: Array  # of the lights, above 0
    common: Array  # (n,), how often each material is taken, sum 1


def scatter(rng: np.random.Generator, materials: int, rules: SceneRules) -> Leaves:
    """Return leaves of @materials, the later ones over the earlier."""
    shape = (rules.height, rules.width)
    concentration = np.exp(rng.uniform(*np.log(rules.common)))
    common = rng.dirichlet(np.full(materials, concentration))
    grain = [texture(rng, shape, power) for power in TEXTURES]
    first, second = (np.full(shape, rng.choice(materials, p=common)) for _ in range(2))
    mix, facing = np.zeros(shape), np.ones(shape)
    for _ in range(rng.integers(rules.leaves[0], rules.leaves[1] + 1)):
        where, inside = leaf(rng, rules)
        one, two = rng.choice(materials, 2, p=common)
        mixed = rng.random() < rules.mixed
        pattern, bumps = (
            grain[i][where][inside] for i in rng.integers(len(grain), size=2)
        )
        share = 0.5 + 0.5 * np.tanh(CONTRAST * pattern + rng.normal())
        first[where][inside], second[where][inside] = one, two
        mix[where][inside] = mixed * rng.random() * share
        bumpy = np.exp(rng.uniform(0.0, BUMPS) * bumps)
        facing[where][inside] = rng.uniform(*rules.facing) * bumpy
    return Leaves(first, second, mix, facing, common)


def leaf(
    rng: np.random.Generator, rules: SceneRules
) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """Return the box of a leaf in the frame, and which of its pixels the leaf covers.

    It is an ellipse or a turned rectangle; its radius falls off as a power law."""
    height, ratio = rules.height, rules.width / rules.height
    radius = min(
        rules.radius[0] * (1.0 - rng.random()) ** -RADIUS_POWER, rules.radius[1]
    )
    centre = rng.uniform(0.0, (1.0, ratio))
    angle, flatness = rng.uniform(0.0, np.pi), rng.uniform(0.25, 1.0)
    reach = 1.5 * radius  # of a rectangle's corners
    lowest = np.floor(np.maximum(centre - reach, 0.0) * height).astype(int)
    highest = np.ceil((centre + reach) * height).astype(int) + 1
    ends = np.minimum(highest, (rules.height, rules.width))
    rows, columns = (
        np.arange(a, b) / height for a, b in zip(lowest, ends, strict=True)
    )
    down, across = rows[:, None] - centre[0], columns[None] - centre[1]
    along = across * np.cos(angle) + down * np.sin(angle)
    beside = (down * np.cos(angle) - across * np.sin(angle)) / flatness
    if rng.random() < 0.5:
        inside = np.maximum(np.abs(along), np.abs(beside)) < radius
    else:
        inside = along**2 + beside**2 < radius**2
    return (slice(lowest[0], ends[0]), slice(lowest[1], ends[1])), inside
