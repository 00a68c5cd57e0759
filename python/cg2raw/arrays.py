# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What arrays the API takes: shapes, types, and what is converted on the way in."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatImage = NDArray[np.float32]
RawImage = NDArray[np.uint16]


def rgb_image(rgb: ArrayLike, what: str = "scene-linear Rec.709") -> NDArray[Any]:
    """Return an (H, W, 3 or 4) image as float32 or float16, the two that need no copy.

    Other floats become float32. Raises ValueError for other shapes and for integers,
    which are no linear light."""
    image = _floating(rgb, "rgb", what)
    if image.ndim != 3 or image.shape[2] not in (3, 4):
        raise ValueError(
            f"rgb must have the shape (H, W, 3) or (H, W, 4), not {image.shape}"
        )
    keep = image.dtype in (np.float32, np.float16) and image.dtype.isnative
    return image if keep else image.astype(np.float32)


def signal_plane(signal: ArrayLike, name: str = "signal") -> FloatImage:
    """Return an (H, W) mosaic, 0..1 above black, as float32. Raises ValueError."""
    plane = _floating(signal, name, "0..1 above black")
    if plane.ndim != 2:
        raise ValueError(f"{name} must have the shape (H, W), not {plane.shape}")
    return plane.astype(np.float32, copy=False)


def output_plane(out: FloatImage | None, signal: FloatImage) -> FloatImage | None:
    """Return where a plane like @signal is written to; None for a new array.

    Raises ValueError for what it cannot be written to as it is, and for memory that a
    part of the signal has."""
    if out is None:
        return None
    if not isinstance(out, np.ndarray) or out.dtype != np.float32:
        kind = getattr(out, "dtype", type(out).__name__)
        raise ValueError(f"out must be an array of native float32, not {kind}")
    if out.shape != signal.shape:
        raise ValueError(f"out must have the shape {signal.shape}, not {out.shape}")
    if not (out.flags.c_contiguous and out.flags.writeable):
        raise ValueError("out must be C-contiguous and writeable")
    if out.ctypes.data != signal.ctypes.data and np.shares_memory(out, signal):
        raise ValueError("out shares memory with a part of signal: give signal itself")
    return out


def raw_plane(raw: ArrayLike) -> RawImage:
    """Return an (H, W) array of uint16 DN, of any byte order, as C-contiguous words of
    this machine. Raises ValueError for all else, other whole numbers too."""
    plane = _array(raw, "raw")
    if plane.ndim != 2 or not is_uint16(plane):
        remedy = "; astype(numpy.uint16) converts what is 0 to 65535"
        raise ValueError(
            f"raw must be (H, W) uint16 DN, not {plane.shape} {plane.dtype}"
            + (remedy if plane.dtype.kind in "iu" else "")
        )
    return np.ascontiguousarray(plane, np.uint16)


def is_uint16(array: NDArray[Any]) -> bool:
    """Return whether an array has words of 16 bits, whatever the order of their bytes:
    FITS and big-endian TIFF files give them as ">u2"."""
    return bool(array.dtype.newbyteorder("=") == np.uint16)


def _array(image: ArrayLike, name: str) -> NDArray[Any]:
    """Return an argument as an array. Raises ValueError for what is none."""
    if isinstance(image, np.ma.MaskedArray):
        raise ValueError(f"{name} is a masked array: fill what is masked, by filled()")
    try:
        return np.asarray(image)
    except ValueError as error:
        raise ValueError(f"{name} is no image: {error}") from None


def _floating(image: ArrayLike, name: str, what: str) -> NDArray[Any]:
    array = _array(image, name)
    if not np.issubdtype(array.dtype, np.floating):
        raise ValueError(
            f"{name} must be floating point, {what}, not {array.dtype}: scale integers "
            "to 0..1 and linearise them first"
        )
    return array


def planes_of(image: ArrayLike) -> FloatImage:
    """Return a mosaic as it is, (H, W, 3 or 4) camera RGB as (3, H, W)."""
    if np.ndim(image) != 3:
        return signal_plane(image, "image")
    rgb = rgb_image(image, "camera RGB")[..., :3]
    return np.ascontiguousarray(np.moveaxis(rgb, -1, 0), np.float32)


def pixels_of(planes: FloatImage) -> FloatImage:
    """Undo planes_of."""
    return (
        np.ascontiguousarray(np.moveaxis(planes, 0, -1)) if planes.ndim == 3 else planes
    )
