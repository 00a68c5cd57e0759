# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Arrays in .npy and .npz files, and RAW frames in them."""

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage, raw_plane
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.system import check_readable

LONGEST = 160  # letters of what NumPy says


def is_npy(path: str) -> bool:
    """Return whether a file is an .npy, by its name."""
    return os.path.splitext(path)[1].lower() == ".npy"


def is_npz(path: str) -> bool:
    """Return whether a file is an .npz, by its name."""
    return os.path.splitext(path)[1].lower() == ".npz"


def frames(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frame of an .npy. Raises ValueError, OSError."""
    if image is not None:
        raise ValueError(f"{path}: holds one frame, and no image {image}")
    area = Area("active", 0, 0, *mapped_dn(path).shape)
    return [RawFile(RawHeader(path, area), lambda levels: mapped_dn(path))]


def frames_of_npz(path: str, image: str | None = None) -> list[RawFile]:
    """Return the arrays of an .npz, or the one whose name is given, each as a frame
    that is read where it is used. Raises ValueError, OSError."""
    check_readable(path)  # NumPy's own message of a missing file has no path
    with whole(path, ".npz"), np.load(path) as stored:
        shapes = {name: shape_in(stored, name) for name in sorted(stored.files)}
    if image is not None and image not in shapes:
        raise ValueError(f"{path}: has no array {image}; it has {', '.join(shapes)}")
    if not shapes:
        raise ValueError(f"{path}: holds no array; give (H, W) uint16 DN")
    chosen = shapes if image is None else {image: shapes[image]}
    return [of_npz(path, name, shape) for name, shape in chosen.items()]


def shape_in(stored: Any, name: str) -> tuple[int, ...]:
    """Return the shape of an array in an .npz, by its header."""
    with stored.zip.open(f"{name}.npy") as member:
        first, _ = np.lib.format.read_magic(member)
        if first == 1:
            return np.lib.format.read_array_header_1_0(member)[0]
        return np.lib.format.read_array_header_2_0(member)[0]


def of_npz(path: str, name: str, shape: tuple[int, ...]) -> RawFile:
    """Return one array of an .npz as a frame. Raises ValueError."""

    def read(levels: object) -> RawImage:
        with whole(path, ".npz"), np.load(path) as stored:
            return as_dn(f"{path}: {name}", stored[name])

    if len(shape) != 2:
        raise ValueError(f"{path}: {name} is {shape}; must be (H, W) uint16 DN")
    return RawFile(RawHeader(path, Area("active", 0, 0, *shape), frame=name), read)


def mapped_dn(path: str) -> RawImage:
    """Return an .npy's DN, mapped from the file. Raises ValueError, OSError."""
    return as_dn(path, mapped(path))


def as_dn(what: str, plane: NDArray[Any]) -> RawImage:
    """Return an array that is a frame. Raises ValueError for any other."""
    try:
        return raw_plane(plane)
    except ValueError as error:
        raise ValueError(f"{what}: {error}; give the active area") from None


def mapped(path: str) -> NDArray[Any]:
    """Return the array of a file, which is read where it is used.

    Raises ValueError for a damaged file or one with less than two dimensions, OSError.
    """
    check_readable(path)  # NumPy's own message of a missing file has no path
    array: NDArray[Any]
    with whole(path, ".npy"), np.errstate(over="ignore"):
        array = np.lib.format.open_memmap(path, mode="r")
    if array.ndim < 2:
        raise ValueError(f"{path}: is no image: give one array, (H, W) or (H, W, 3)")
    return array


@contextlib.contextmanager
def whole(path: str, kind: str) -> Iterator[None]:
    """Raise ValueError in one line for whatever NumPy raises of a damaged file.

    Those are errors of its own, and of Python's tokenizer, zip files and integers."""
    try:
        yield
    except Exception as error:
        words = " ".join(f"{error}".split())[:LONGEST]
        raise ValueError(f"{path}: is no {kind} file, or cut off: {words}") from None
