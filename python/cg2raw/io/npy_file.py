# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Arrays in .npy files."""

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.system import check_readable

LONGEST = 160  # letters of what NumPy says


def is_npy(path: str) -> bool:
    """Return whether a file is an .npy, by its name."""
    return os.path.splitext(path)[1].lower() == ".npy"


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
