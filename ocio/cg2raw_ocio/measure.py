# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How far an exported file is from what the core computes, in DN of 16 bits."""

import dataclasses
from typing import Any

import numpy as np
import PyOpenColorIO as ocio
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage

from . import chain, color_effects, spaces

WHITE_DN = 65535
PIXELS = 200_000
RAMP_STEPS = 4096


@dataclasses.dataclass(frozen=True)
class Error:
    """Largest and mean absolute difference of channels, DN of 16 bits."""

    max_dn: float
    mean_dn: float

    def __str__(self) -> str:
        return f"max {_digits(self.max_dn)} DN, mean {_digits(self.mean_dn)} DN"


def _digits(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def random_pixels() -> FloatImage:
    """Return (PIXELS, 3) float32 in 0..1, the same in each run."""
    words = np.random.Generator(np.random.PCG64(1)).random((PIXELS, 3))
    return words.astype(np.float32)


def neutral_ramp() -> FloatImage:
    """Return (RAMP_STEPS, 3) float32, black to white."""
    values = np.linspace(0, 1, RAMP_STEPS, dtype=np.float32)
    return np.repeat(values[:, None], 3, axis=1)


def exact_camera(
    profile: _core.SensorProfile,
    illuminant: str,
    exposure: spaces.Exposure,
    pixels: NDArray[Any],
) -> FloatImage:
    """Return (n, 3) float32 camera RGB of (n, 3) linear Rec.709, by the core."""
    transform = spaces.camera_transform(profile, illuminant, exposure)
    row = np.ascontiguousarray(pixels, np.float32)[None]
    return color_effects.applied(
        profile, illuminant, _core.to_camera(transform, row)[0]
    )


def below_highlights(
    transform: _core.CameraTransform, pixels: NDArray[Any]
) -> NDArray[np.bool_]:
    """Return which pixels, balanced, have a mean up to 0.9: none is protected there."""
    balanced = np.clip(pixels.astype(float) @ transform.first.T, 0, 1)
    if transform.two_steps:
        balanced = np.clip(balanced @ transform.second.T, 0, 1)
    return np.asarray(balanced.mean(axis=1) <= chain.HIGHLIGHT_START)


def applied(transform: chain.Op, pixels: NDArray[Any]) -> FloatImage:
    """Return the (n, 3) float32 pixels through one OCIO transform, on the CPU."""
    image = np.ones((len(pixels), 4), np.float32)
    image[:, :3] = pixels
    processor = ocio.Config.CreateRaw().getProcessor(transform)
    cpu = processor.getDefaultCPUProcessor()
    cpu.apply(ocio.PackedImageDesc(image, len(image), 1, 4))
    return image[:, :3]


def error(found: NDArray[Any], exact: NDArray[Any]) -> Error:
    """Return the Error of (n, 3) camera RGB; no pixels are no error."""
    if not len(found):
        return Error(0.0, 0.0)
    difference = np.abs(found.astype(float) - exact) * WHITE_DN
    return Error(float(difference.max()), float(difference.mean()))
