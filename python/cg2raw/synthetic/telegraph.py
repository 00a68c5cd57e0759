# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Traps that are full or empty: pixels whose level jumps from frame to frame."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.light import Hidden

LONGEST = 4.0  # means of a step, that traps are cut at


@dataclass(frozen=True)
class Traps:
    """step : (H, W) DN between a pixel's levels, 0 of most. switches : chance of the
    other state in the next frame. start : (H, W) first state."""

    step: Plane
    switches: float
    start: NDArray[np.bool_]


def traps_of(
    rng: Generator, shape: tuple[int, int], hidden: Hidden, camera: Camera
) -> Traps | None:
    """Draw the traps of one sensor; None if it has none."""
    if "random_telegraph_noise" not in hidden:
        return None
    v = hidden["random_telegraph_noise"]
    trapped = rng.random(shape) < v["share"]
    size = -np.log1p(-rng.random(shape) * -np.expm1(-LONGEST))  # exponential, cut
    unit = camera.over(camera.dn_per_electron * camera.read_noise, shape)
    step = np.where(trapped, v["read_noises"] * unit * size, 0.0)
    return Traps(step, v["switches"], rng.random(shape) < 0.5)


def offsets(traps: Traps, frame: int, rng_of: Callable[[int], Generator]) -> Plane:
    """Return (H, W) DN that the traps add to a frame, whose number counts from 0: a
    Markov chain of two states. rng_of : random numbers of each frame before it."""
    full = traps.start.copy()
    for number in range(1, frame + 1):
        full ^= rng_of(number).random(full.shape) < traps.switches
    added: Plane = traps.step * np.where(full, 0.5, -0.5)
    return added
