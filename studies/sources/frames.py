# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What every source returns, and the words in which cg2raw takes a neutral."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor
from studies.world.colorimetry import Array

Image = NDArray[np.float32]


@dataclass(frozen=True)
class Frames:
    """Camera RGB of a source, unbounded: studies.world.exposure.exposed clips it."""

    images: list[Image]  # (H, W, 3) each, linear
    neutrals: Array  # (n, 3), G = 1
    sensors: tuple[Sensor, ...] = ()  # each frame's own, where they differ
    own: tuple[Image, ...] = ()  # exposed as the source does; none: as a camera does


TestSets = Mapping[str, Frames]  # of the camera, by name


def words_of(neutrals: Array) -> list[str]:
    """Return illuminants, as cg2raw has them, of neutrals (n, 3), G = 1."""
    return [f"neutral:{red:.6f}:{blue:.6f}" for red, _, blue in neutrals]


def framed(pairs: Iterable[tuple[Image, Array | Sequence[float]]]) -> Frames:
    """Return the Frames of images and their neutrals (3,)."""
    images, neutrals = zip(*pairs, strict=True)
    return Frames(list(images), np.array(neutrals))
