# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 1: illuminant estimation trained on each source, tested on the camera's frames.

Each seed draws the training set, the first weights and the order anew. All sources of a
seed have as many frames, the same exposure, network and schedule; the rendered images
are the same for all sources but real, and of other scenes than the real ones."""

import importlib.util

import numpy as np
from numpy.typing import NDArray

from studies.cameras import Camera
from studies.protocol import IlluminantRules
from studies.sources.frames import Frames
from studies.sources.real import real
from studies.sources.sets import material, sources
from studies.tasks.angles import degrees
from studies.world.exposure import exposed
from studies.world.shots import World, shots

Errors = dict[str, list[list[float]]]  # source: of each seed, of each test frame


def need_torch() -> None:
    """Raise ValueError without PyTorch."""
    if importlib.util.find_spec("torch") is None:
        raise ValueError(
            "the study illuminant needs PyTorch: pip install torch --index-url "
            "https://download.pytorch.org/whl/cpu; the other studies run without it"
        )


def illuminant(world: World, camera: Camera, mode: str) -> Errors:
    """Return the errors in degrees of each source's networks. mode : quick or full."""
    from studies.learners.convolutional_mean import train

    need_torch()
    rules = world.protocol.illuminant
    frames = rules.frames[mode]
    tests = test_frames(world, camera, rules, mode)
    images = thumbnails(tests, rules.block)
    errors: Errors = {}
    for seed in range(rules.draws[mode]):
        found = material(world, camera, "day", world.protocol.seeds, frames, seed)
        for name, make in sources(found, camera, seed).items():
            made = make()
            small = thumbnails(made, rules.block)
            learnt = train(small, made.neutrals, rules, rules.epochs[mode], seed)
            estimates = learnt.estimates(images)
            of_frames = degrees(estimates, tests.neutrals).round(4).tolist()
            errors.setdefault(name, []).append(of_frames)
    return errors


def test_frames(
    world: World, camera: Camera, rules: IlluminantRules, mode: str
) -> Frames:
    """Return the camera's frames of the test half, the same for all seeds."""
    count = rules.tests[mode]
    tests = shots(world, "test", "day", camera.cards, rules.first, count)
    return real(tests, camera.sensitivities)


def thumbnails(frames: Frames, block: int) -> NDArray[np.float32]:
    """Return (n, h, w, 3) of frames as a sensor keeps them, means of block x block."""
    small = []
    for image in map(exposed, frames.images):
        height, width = (size // block for size in image.shape[:2])
        whole = image[: height * block, : width * block]
        parts = whole.reshape(height, block, width, block, 3)
        small.append(parts.mean(axis=(1, 3)))
    return np.stack(small).astype(np.float32)
