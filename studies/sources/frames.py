# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What every source returns, and the words in which cg2raw takes a neutral."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor
from studies.world.colorimetry import Array
from studies.world.exposure import exposure

Image = NDArray[np.float32]


@dataclass(frozen=True)
class Frames:
    """Camera RGB of a source, unbounded: a sensor clips it to 0..1."""

    images: list[Image]  # (H, W, 3) each, linear
    neutrals: Array  # (n, 3), G = 1
    sensors: tuple[Sensor, ...] = ()  # each frame's own, where they differ
    # What an observer sees of each, the main light adapted to D65: (H, W, 3) linear
    # Rec.709 on the scale of green of a white. None: nobody measured it.
    scenes: tuple[Image, ...] = ()

    def chosen(self, which: NDArray[np.bool_]) -> "Frames":
        """Return the frames of a mask (n,), whose sensor is the camera's."""
        kept = np.flatnonzero(which)
        images = [self.images[number] for number in kept]
        scenes = tuple(self.scenes[number] for number in kept if self.scenes)
        return Frames(images, self.neutrals[kept], scenes=scenes)


TestSets = Mapping[str, Frames]  # of the camera, by name


def words_of(neutrals: Array) -> list[str]:
    """Return illuminants, as cg2raw has them, of neutrals (n, 3), G = 1."""
    return [f"neutral:{red:.6f}:{blue:.6f}" for red, _, blue in neutrals]


def captured(frames: Frames) -> Frames:
    """Return frames, images and scenes alike, as a camera's auto exposure has them."""
    scales = [np.float32(exposure(image)) for image in frames.images]
    images, scenes = (
        [image * scale for image, scale in zip(found, scales, strict=False)]
        for found in (frames.images, frames.scenes)
    )
    return replace(frames, images=images, scenes=tuple(scenes))


def cast(renders: Sequence[Image], neutrals: Array) -> Frames:
    """Return the Frames of renders multiplied by neutrals (n, 3): no matrix."""
    pairs = zip(renders, neutrals, strict=True)
    images = [np.asarray(render * neutral, np.float32) for render, neutral in pairs]
    return Frames(images, neutrals, scenes=tuple(renders))


def framed(pairs: Iterable[tuple[Image, Array | Sequence[float]]]) -> Frames:
    """Return the Frames of images and their neutrals (3,)."""
    images, neutrals = zip(*pairs, strict=True)
    return Frames(list(images), np.array(neutrals))
