# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Arrays in .npy files."""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray


def is_npy(path: str) -> bool:
    """Return whether a file is an .npy, by its name."""
    return os.path.splitext(path)[1].lower() == ".npy"


def mapped(path: str) -> NDArray[Any]:
    """Return the array of a file, which is read where it is used.

    Raises ValueError for a damaged file or one with less than two dimensions, OSError.
    """
    with open(path, "rb"):  # NumPy's own message of a missing file has no path
        pass
    try:
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise ValueError(f"{path}: is no .npy file, or cut off: {error}") from None
    if not isinstance(array, np.ndarray) or array.ndim < 2:
        raise ValueError(f"{path}: is no image: give one array, (H, W) or (H, W, 3)")
    return array
