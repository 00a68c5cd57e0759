# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source upi: random cameras of ten sensors' D65 matrices and uniform gains."""

from collections.abc import Sequence
from dataclasses import replace

from cg2raw import Sensor
from cg2raw.upi import Upi
from studies.sources.frames import Frames, Image, framed

# As in UPI's paper; of this camera's own box of neutrals; as the authors of
# Graphics2RAW set UPI for their ten cameras (red 1.0..3.3, blue 1.3..4.4).
GAINS = ("published", "camera", "graphics2raw")


def upi(
    images: Sequence[Image],
    sensor: Sensor,
    gains: str = "graphics2raw",
    *,
    lights: Sequence[str] = (),
    seed: int = 0,
) -> Frames:
    """Return the Frames of rendered images (H, W, 3), linear sRGB, exposed.

    gains : one of GAINS; camera needs a sensor with neutrals.
    lights : words, one for each image, in place of drawn gains.
    Their own exposure is that of the renders times the global gain of each draw; images
    of equal exposure have gain 1."""
    drawer = Upi(sensor, gains=gains)
    first = seed * len(images)
    draws = [drawer.draw(number) for number in range(first, first + len(images))]
    words = lights or [draw.illuminant for draw in draws]
    drawn = list(zip(images, draws, words, strict=True))
    made = framed(
        (
            draw.sensor.to_camera(image, illuminant=word),
            draw.sensor.illuminant(word).neutral,
        )
        for image, draw, word in drawn
    )
    own = (
        draw.sensor.to_camera(image, illuminant=word, digital_gain=draw.digital_gain)
        for image, draw, word in drawn
    )
    sensors = tuple(draw.sensor for draw in draws)
    return replace(made, sensors=sensors, own=tuple(own))
