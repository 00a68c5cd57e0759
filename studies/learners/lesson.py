# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What learners of denoising are given, and what they give back."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
Noisy = Callable[[Array, np.random.Generator], Array]  # clean planes with noise
Denoiser = Callable[[Array], Array]  # noisy planes (n, 4, h, w) to clean ones


@dataclass(frozen=True)
class Lesson:
    """Clean planes of a source's frames, and the noise that is to be taken away."""

    clean: Array  # (n, 4, h, w): the sites of RGGB
    noisy: Noisy
    white: float  # what saturation has become in them
    validation: int  # of the frames, the last so many choose among what is learnt
    seed: int
    name: str = ""  # of the run, different for all


Learner = Callable[[Lesson], Denoiser]
