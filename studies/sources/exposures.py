# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sources of ours at the exposures that users of cg2raw may give renders.

An exposure is a gain on scene-linear values before anything clips, of the words of
cg2raw.Run; the core decides it."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from cg2raw import Run, Sensor
from studies.cameras import Camera
from studies.sources.frames import Frames, Image, words_of
from studies.sources.ours import ours
from studies.sources.sets import Material, Sources
from studies.world.exposure import exposed

WORDS = {"as rendered": "0", "random": "random:0:2", "auto": "auto"}
REC709 = np.array([0.2126, 0.7152, 0.0722], np.float32)  # luminance
LIGHT = "D65"  # of a run whose exposure alone is asked for


def by_exposure(found: Material, camera: Camera, seed: int) -> Sources:
    """Return what makes the training frames of a seed: the camera, and arms of ours.

    "ours, dng" is that of the other studies: each render's highlights at white.
    "captures' median" brightens all renders by as many stops as they are darker in the
    median."""
    told, images = camera.told(found.captures.neutrals), found.as_rendered

    def at(exposure: str) -> Frames:
        return ours(exposed_by(told, images, exposure, seed), told, seed=seed)

    def as_bright() -> Frames:
        return at(str(darker(told, found.captures, images)))

    return {
        "real": lambda: found.captures,
        "real, other scenes": lambda: found.other_captures,
        "ours, dng": lambda: ours(found.renders, told, seed=seed),
        **{f"ours, {name}": partial(at, word) for name, word in WORDS.items()},
        "ours, captures' median": as_bright,
    }


def exposed_by(
    sensor: Sensor, images: Sequence[Image], exposure: str, seed: int
) -> list[Image]:
    """Return images (H, W, 3) as cg2raw exposes them, frame by frame of one seed."""
    made = []
    for frame, image in enumerate(images):
        asked = Run(illuminant=LIGHT, exposure=exposure, seed=seed, frame=frame)
        run = sensor.metered(image, asked)
        found = sensor.simulation(image.shape[:2], **vars(run)).exposure
        made.append(np.asarray(image * np.float32(2.0 ** found["stops"]), np.float32))
    return made


def darker(sensor: Sensor, captures: Frames, images: Sequence[Image]) -> float:
    """Return how many stops images (H, W, 3) are darker than captures as a camera
    exposes them: their median luminances, in the median."""
    developed = [
        sensor.to_scene(exposed(image), illuminant=word)
        for image, word in zip(
            captures.images, words_of(captures.neutrals), strict=True
        )
    ]
    bright, dark = (
        np.median([np.median(image @ REC709) for image in scenes])
        for scenes in (developed, images)
    )
    return float(np.log2(bright / dark))
