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
from studies.sources.frames import Frames, TestSets
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.tasks.angles import degrees
from studies.world.exposure import exposed
from studies.world.lights import mccamy
from studies.world.scene import Shot
from studies.world.shots import World, lit_by, shots

LEDS = "LED lamps"
BY_KELVIN = {  # of main lights; of 200 test frames, 20 or more are of each
    "below 3000 K": (0.0, 3000.0),
    "3000 to 4500 K": (3000.0, 4500.0),
    "4500 to 5000 K": (4500.0, 5000.0),
    "5000 to 5500 K": (5000.0, 5500.0),
    "5500 to 6000 K": (5500.0, 6000.0),
    "above 6000 K": (6000.0, np.inf),
}
Errors = dict[str, dict[str, list[float]]]  # tests: source: of each frame


def need_torch() -> None:
    """Raise ValueError without PyTorch."""
    if importlib.util.find_spec("torch") is None:
        raise ValueError(
            "networks need PyTorch, which ./scripts/evidence installs; classical, "
            "colour, denoising and isp run without it"
        )


def illuminant_draw(draw: Draw, made: Sources, tests: TestSets) -> Errors:
    """Return the errors in degrees of networks that are trained on each source."""
    from studies.learners.convolutional_mean import train

    need_torch()
    rules = draw.world.protocol.illuminant
    epochs = rules.epochs[draw.mode]
    images = {name: thumbnails(frames, rules.block) for name, frames in tests.items()}
    errors: Errors = {name: {} for name in tests}
    for source, make in made.items():
        own = make()
        small = thumbnails(own, rules.block)
        learnt = train(small, own.neutrals, rules, epochs, draw.seed)
        for name, frames in tests.items():
            found = degrees(learnt.estimates(images[name]), frames.neutrals)
            errors[name][source] = found.round(4).tolist()
    return errors


def light_draws_draw(draw: Draw, made: Sources, tests: TestSets) -> Errors:
    """Return the errors of the sources that tell what the drawing of lights is worth.

    Exploratory: it was asked after study 1 had been seen."""
    few = {source: made[source] for source in draw.world.protocol.light_draws.sources}
    return illuminant_draw(draw, few, tests)


def held_out_draw(draw: Draw, made: Sources, tests: TestSets) -> Errors:
    """Return the errors of the sources that the protocol names for held-out LEDs."""
    names = draw.world.protocol.held_out_leds.sources
    return illuminant_draw(draw, {source: made[source] for source in names}, tests)


def test_frames(world: World, camera: Camera, mode: str) -> Frames:
    """Return the camera's frames of the test half, the same for all seeds."""
    return real(test_shots(world, camera, mode), camera.sensitivities)


def test_shots(world: World, camera: Camera, mode: str) -> list[Shot]:
    """Return the shots of the test frames."""
    rules = world.protocol.illuminant
    return shots(world, "test", "day", camera.cards, rules.first, rules.tests[mode])


def tests_by_light(world: World, camera: Camera, mode: str) -> dict[str, Frames]:
    """Return the test frames by the colour temperature of their main lights, and as
    many whose lights are LEDs."""
    taken = test_shots(world, camera, mode)
    frames = real(taken, camera.sensitivities)
    kelvin = mccamy(np.array([shot.lights[0] for shot in taken]))
    found = {
        name: frames.chosen((kelvin >= low) & (kelvin < high))
        for name, (low, high) in BY_KELVIN.items()
        if ((kelvin >= low) & (kelvin < high)).any()
    }
    return {**found, LEDS: test_frames(lit_by(world, leds=True), camera, mode)}


def thumbnails(frames: Frames, block: int) -> NDArray[np.float32]:
    """Return (n, h, w, 3) of frames as a sensor keeps them, means of block x block."""
    small = []
    for image in map(exposed, frames.images):
        height, width = (size // block for size in image.shape[:2])
        whole = image[: height * block, : width * block]
        parts = whole.reshape(height, block, width, block, 3)
        small.append(parts.mean(axis=(1, 3)))
    return np.stack(small).astype(np.float32)
