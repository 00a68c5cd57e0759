# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sources of ours at the exposures that users of cg2raw may give renders.

An exposure is a gain on scene-linear values before anything clips, of the words of
cg2raw.Run; the core decides it. One is of the training captures, as `cg2raw match`
finds it."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from cg2raw import Run, Sensor
from cg2raw.match import Comparison, Frame, compare, look
from cg2raw.match.renders import Model, simulated
from studies.cameras import Camera
from studies.sources.frames import Frames, Image, words_of
from studies.sources.ours import drawn, ours
from studies.sources.sets import Material, Sources
from studies.world.exposure import exposed

WORDS = {"as rendered": "0", "random": "random:0:2", "auto": "auto"}
REC709 = np.array([0.2126, 0.7152, 0.0722], np.float32)  # luminance
LIGHT = "D65"  # of a run whose exposure alone is asked for


def by_exposure(found: Material, camera: Camera, seed: int) -> Sources:
    """Return what makes the training frames of a seed: the camera, and arms of ours.

    "ours, dng" is that of the other studies: each render's highlights at white.
    "match" gives renders the levels of the captures, "match, drawn" exposures of the
    distribution that is found, whatever the render; "captures' median" brightens all by
    as many stops as they are darker in the median."""
    told, images = camera.told(found.captures.neutrals), found.as_rendered

    def at(exposure: str) -> Frames:
        return ours(exposed_by(told, images, exposure, seed), told, seed=seed)

    def matched(how: str = "") -> Frames:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "match.json"
            path.write_text(json.dumps(matching(told, found.captures, images).fields()))
            return at(f"match:{path}{how}")

    def as_bright() -> Frames:
        return at(str(darker(told, found.captures, images)))

    return {
        "real": lambda: found.captures,
        "real, other scenes": lambda: found.other_captures,
        "ours, dng": lambda: ours(found.renders, told, seed=seed),
        **{f"ours, {name}": partial(at, word) for name, word in WORDS.items()},
        "ours, match": matched,
        "ours, match, drawn": partial(matched, ":draw"),
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


def matching(sensor: Sensor, captures: Frames, images: Sequence[Image]) -> Comparison:
    """Return the Comparison of captures as a camera exposes them, and of images
    (H, W, 3) under lights that are drawn as those of source ours."""
    words = words_of(captures.neutrals)
    seen = [
        captured(sensor, exposed(image), word)
        for image, word in zip(captures.images, words, strict=True)
    ]
    model = Model(sensor, drawn(len(images), 0))
    made = [simulated("", image, frame, model) for frame, image in enumerate(images)]
    return compare(sensor.id, seen, made)


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


def captured(sensor: Sensor, image: Image, word: str) -> Frame:
    """Return the match's Frame of camera RGB (H, W, 3), white 1, under a light."""
    plane = sensor.raw_from_signal(sensor.mosaic(image))
    return look("", plane, sensor, sensor.illuminant(word))
