# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A denoiser by U-net: packed planes to packed planes. It needs PyTorch."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studies.learners.lesson import Array, Denoiser, Learner, Lesson
from studies.learners.unet import Examples, Trained, train
from studies.protocol import UnetRules

SITES = ((0, 0), (0, 1), (1, 0), (1, 1))  # row and column of the planes of RGGB


@dataclass(frozen=True)
class UnetDenoiser:
    """A network that is shown planes whose white is 1."""

    trained: Trained
    white: float

    def __call__(self, noisy: Array) -> Array:
        """Return planes (n, 4, h, w) of noisy ones."""
        white = np.float32(self.white)
        return np.asarray(self.trained(noisy / white) * white, np.float32)


def unet_learner(rules: UnetRules, mode: str, folder: Path | None = None) -> Learner:
    """Return the Learner of a U-net. mode : quick or full.

    folder : of checkpoints, a file for each lesson's name; a training that was stopped
        goes on, and one that is done is read."""

    def learner(lesson: Lesson) -> Denoiser:
        white = np.float32(lesson.white)

        def shown(planes: Array, rng: np.random.Generator) -> Array:
            return np.asarray(lesson.noisy(planes * white, rng) / white, np.float32)

        clean = lesson.clean / white
        examples = Examples(clean, clean, lesson.validation, shown, SITES, True)
        path = None if folder is None else folder / f"{file_name(lesson.name)}.pt"
        steps = rules.steps[mode]
        return UnetDenoiser(
            train(examples, rules, steps, lesson.seed, path), lesson.white
        )

    return learner


def file_name(name: str) -> str:
    """Return a name without what file systems or shells take for their own."""
    return "".join(c if c.isalnum() or c in "-." else "_" for c in name)
