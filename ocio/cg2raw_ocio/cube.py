# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A preview of one RAW space as a 3D LUT, for applications without OpenColorIO.

The text is that of Adobe's Cube LUT specification 1.0, which Iridas began and Resolve
reads: red fastest, domain 0 to 1."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw._core import SensorProfile

from . import measure
from .spaces import Exposure

SIZES = (2, 129)
INPUTS = ("linear", "srgb")


def cube_text(
    profile: SensorProfile,
    illuminant: str,
    exposure: Exposure,
    size: int,
    encoding: str,
    title: str,
) -> str:
    """Return the text of the LUT of @size^3: Rec.709 of @encoding -> camera RGB.

    Raises ValueError for a size outside 2 to 129."""
    if not SIZES[0] <= size <= SIZES[1]:
        raise ValueError(f"--cube-size {size}: must be {SIZES[0]} to {SIZES[1]}")
    grid = np.arange(size) / (size - 1)
    blue, green, red = np.meshgrid(grid, grid, grid, indexing="ij")
    inputs = np.stack([red, green, blue], axis=-1).reshape(-1, 3)
    camera = measure.exact_camera(
        profile, illuminant, exposure, linear_from(inputs, encoding)
    )
    head = f'TITLE "{title}"\nLUT_3D_SIZE {size}\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\n'
    rows = (f"{r:.7f} {g:.7f} {b:.7f}\n" for r, g, b in camera.tolist())
    return head + "".join(rows)


def linear_from(values: NDArray[Any], encoding: str) -> NDArray[Any]:
    """Return scene-linear values of linear or sRGB-encoded ones, both in 0..1.

    Source: IEC 61966-2-1."""
    if encoding == "linear":
        return values
    toe = values / 12.92
    return np.where(values <= 0.04045, toe, ((values + 0.055) / 1.055) ** 2.4)


def encoded_from(values: NDArray[Any], encoding: str) -> NDArray[Any]:
    """Return the inverse of linear_from."""
    if encoding == "linear":
        return values
    toe = values * 12.92
    return np.where(values <= 0.0031308, toe, 1.055 * values ** (1 / 2.4) - 0.055)
