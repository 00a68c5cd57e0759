# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source translation: renders that a network has made like balanced RAW of the camera.

Balanced RAW is camera RGB over the neutral. The network never saw a render and RAW of
one scene; it is learners.translation's, which is trained on exposed() renders and
balanced() captures. A neutral is what makes RAW of a translated render: gains are drawn
as UPI does, the published form of this source, or lights are given."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cg2raw import Sensor
from cg2raw.upi import Upi
from studies.sources.frames import Frames, Image, framed
from studies.world.exposure import exposed

# Of exposed renders (H, W, 3), 0..1, what is like exposed, balanced captures.
Translator = Callable[[Sequence[Image]], list[Image]]


def translation(
    images: Sequence[Image],
    translator: Translator,
    sensor: Sensor,
    gains: str = "graphics2raw",
    *,
    lights: Sequence[str] = (),
    seed: int = 0,
) -> Frames:
    """Return the Frames of rendered images (H, W, 3), linear sRGB, 0 or above.

    gains : one of sources.upi.GAINS; camera needs a sensor with neutrals.
    lights : words, one for each image, in place of drawn gains; those of sources.ours
        are drawn(len(images), seed).
    A frame is as bright as the network leaves it, and no truth is known of it: its
    scene is what the sensor's matrices make of it."""
    words = lights or drawn_gains(len(images), sensor, gains, seed)
    neutrals = [sensor.illuminant(word).neutral for word in words]
    made = [
        image * np.asarray(neutral, np.float32)
        for image, neutral in zip(
            translator([exposed(image) for image in images]), neutrals, strict=True
        )
    ]
    scenes = tuple(
        sensor.to_scene(image, illuminant=word)
        for image, word in zip(made, words, strict=True)
    )
    return replace(framed(zip(made, neutrals, strict=True)), scenes=scenes)


def drawn_gains(count: int, sensor: Sensor, gains: str, seed: int) -> list[str]:
    """Return words of UPI's gains, the same as sources.upi draws by this seed."""
    drawer = Upi(sensor, gains=gains, digital_gain=1.0)
    numbers = range(seed * count, (seed + 1) * count)
    return [drawer.draw(number).illuminant for number in numbers]


def balanced(captures: Frames) -> list[Image]:
    """Return captures over their neutrals, exposed."""
    return [
        exposed(image / neutral.astype(np.float32))
        for image, neutral in zip(captures.images, captures.neutrals, strict=True)
    ]
