# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rendered images of a folder, such as the scenes at night, in place of the world's.

They differ from the camera's frames in what they show, as renders do."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.image_file import read_image
from studies.places import files_hash
from studies.protocol import SceneRules
from studies.sources.frames import Image

PATTERN = "*.exr"
KEY = 61  # of a generator
MARGIN = 1.25  # a shrunk image's height over a frame's, at most: room for crops


@dataclass(frozen=True)
class Renders:
    """Images (H, W, 3), scene-linear Rec.709, shrunk so that a frame fits in each."""

    images: list[NDArray[np.float16]]
    shape: tuple[int, int]  # rows, columns of a frame
    digest: str  # of the files' names and bytes

    def drawn(self, count: int, seed: int) -> list[Image]:
        """Return count images, a crop of each, drawn by the seed.

        None is there twice unless count is more than there are."""
        rng = np.random.default_rng([seed, KEY])
        order: list[int] = []
        while len(order) < count:
            order += rng.permutation(len(self.images)).tolist()
        return [self.crop(self.images[number], rng) for number in order[:count]]

    def crop(self, image: NDArray[np.float16], rng: np.random.Generator) -> Image:
        """Return a part of an image, of a frame's shape, mirrored at even odds."""
        rows, columns = self.shape
        top = rng.integers(image.shape[0] - rows + 1)
        left = rng.integers(image.shape[1] - columns + 1)
        part = image[top : top + rows, left : left + columns].astype(np.float32)
        return np.ascontiguousarray(part[:, ::-1] if rng.random() < 0.5 else part)


def read_renders(folder: Path, rules: SceneRules) -> Renders:
    """Return the Renders of a folder. Raises ValueError naming folder or file."""
    paths = sorted(folder.glob(PATTERN))
    if not paths:
        raise ValueError(
            f"{folder}: holds no renders ({PATTERN}); "
            f"./studies/run night-scenes {folder} makes them"
        )
    shape = (rules.height, rules.width)
    images = [shrunk(path, shape) for path in paths]
    return Renders(images, shape, files_hash(paths))


def shrunk(path: Path, shape: tuple[int, int]) -> NDArray[np.float16]:
    """Return an image of means of blocks. Raises ValueError if it is too small."""
    pixels = read_image(path).pixels
    height, width = pixels.shape[:2]
    if height < shape[0] or width < shape[1]:
        raise ValueError(
            f"{path}: is {width}x{height}, and a frame of the studies is "
            f"{shape[1]}x{shape[0]}: render it larger"
        )
    most = np.divide((height, width), shape) / MARGIN
    block = max(1, int(most.min()))
    rows, columns = height // block, width // block
    whole = pixels[: rows * block, : columns * block]
    means = whole.reshape(rows, block, columns, block, 3).mean(axis=(1, 3))
    return np.asarray(means.clip(0.0, 65504.0), np.float16)
