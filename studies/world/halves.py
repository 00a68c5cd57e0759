# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The two halves of the world, for training and for tests."""

from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

Half = Literal["train", "test"]
HALVES: tuple[Half, Half] = ("train", "test")
Value = TypeVar("Value")


def halved(count: int, key: int) -> dict[Half, NDArray[np.intp]]:
    """Return indices below @count, each in one half; a pure function of both."""
    order = np.random.default_rng([key, count]).permutation(count)
    middle = count // 2
    return {"train": np.sort(order[:middle]), "test": np.sort(order[middle:])}


def generator(half: Half, seed: int, *key: int) -> np.random.Generator:
    """Return the generator of a seed in a half: no two halves have one alike."""
    return np.random.default_rng([HALVES.index(half), seed, *key])
