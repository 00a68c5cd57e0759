# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What was in front of the lens, as scene-linear Rec.709; and masks."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import FloatImage
from cg2raw.io import image_facts, image_file, npy_file

Mask = NDArray[np.bool_]


def typed(name: str, value: str) -> str:
    """Return an option as the manifest has it."""
    return f"{name}: {value}" if value else name


MANIFEST = image_facts.dialect(typed, is_linear="linearize: none")


def uniform(color: tuple[float, ...], gain: float) -> Callable[[], FloatImage]:
    """Return a scene of one colour: () -> (3,) float32."""
    value = (np.array(color, np.float64) * gain).astype(np.float32)
    return value.copy


def image_size(path: str) -> tuple[int, int]:
    """Return (H, W) of an image or .npy, by its header. Raises ValueError, OSError."""
    if npy_file.is_npy(path):
        shape = npy_file.mapped(path).shape
        return shape[0], shape[1]
    return image_file.image_size(path)


def has_curve(path: str) -> bool:
    """Return whether an image has integers, which a curve encodes."""
    return not npy_file.is_npy(path) and image_file.has_integers(path)


def read_scene(path: str, gain: float, linearize: str | None) -> FloatImage:
    """Return (H, W, 3) float32 scene-linear Rec.709 times gain.

    linearize : None: by the curve that the file states; "srgb": by sRGB's; "none": the
    pixels are linear, whatever it states.
    Raises ValueError for another colour space, for whole numbers that state none, and
    for a pixel that is not finite."""
    if npy_file.is_npy(path):
        if linearize == "srgb":
            raise ValueError(f"{path}: linearize: its floats are linear; remove it")
        pixels = npy_file.mapped(path)
        if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype.kind != "f":
            raise ValueError(
                f"{path}: is {pixels.shape} {pixels.dtype}; must be (H, W, 3) floats, "
                "scene-linear Rec.709"
            )
        rgb = pixels.astype(np.float32)
    else:
        rgb = image_file.read_image(
            path,
            undo=linearize if linearize == "srgb" else "stated",
            space=image_facts.REC709 if linearize == "none" else None,
            dialect=MANIFEST,
        ).pixels
    check_finite(path, rgb)
    rgb *= np.float32(gain)
    return rgb


def check_finite(path: str, rgb: FloatImage) -> None:
    """Raise ValueError naming the first pixel that is not finite."""
    if np.isfinite(rgb.sum(dtype=np.float64)):
        return
    row, col, channel = np.argwhere(~np.isfinite(rgb))[0]
    raise ValueError(
        f"{path}: {'RGB'[channel]} of row {row}, column {col} is "
        f"{rgb[row, col, channel]}; paint it over, or mask it and set it to 0"
    )


def read_mask(path: str, shape: tuple[int, int]) -> Mask:
    """Return (H, W) bool, False where the first channel is 0. Raises ValueError."""
    if npy_file.is_npy(path):
        plane = np.array(npy_file.mapped(path))
    else:
        plane = image_file.read_plane(path)
    if plane.shape != shape:
        raise ValueError(
            f"{path}: is {size_words(plane.shape)}, not {size_words(shape)}"
        )
    mask: Mask = plane != 0
    if not mask.any():
        raise ValueError(f"{path}: masks every pixel; 0 is for what to ignore")
    return mask


def size_words(shape: tuple[int, ...]) -> str:
    """Return "width x height" of (H, W)."""
    return f"{shape[1]}x{shape[0]}" if len(shape) == 2 else str(shape)
