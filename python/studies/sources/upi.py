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
    """Return the Frames of rendered images (H, W, 3), linear sRGB.

    gains : one of GAINS; camera needs a sensor with neutrals.
    lights : words, one for each image, in place of drawn gains."""
    drawer = Upi(sensor, gains=gains, digital_gain=1.0)
    first = seed * len(images)
    draws = [drawer.draw(number) for number in range(first, first + len(images))]
    words = lights or [draw.illuminant for draw in draws]
    made = framed(
        (
            draw.sensor.to_camera(image, illuminant=word),
            draw.sensor.illuminant(word).neutral,
        )
        for image, draw, word in zip(images, draws, words, strict=True)
    )
    return replace(made, sensors=tuple(draw.sensor for draw in draws))
