# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source upi: random cameras of ten sensors' D65 matrices and uniform gains."""

from collections.abc import Sequence
from dataclasses import replace

from cg2raw import Sensor
from cg2raw.upi import Upi
from studies.sources.frames import Frames, Image, framed
from studies.sources.ours import gained

# As in UPI's paper; of this camera's own box of neutrals; as the authors of
# Graphics2RAW set UPI for their ten cameras (red 1.0..3.3, blue 1.3..4.4).
GAINS = ("published", "camera", "graphics2raw")


def upi(
    images: Sequence[Image],
    sensor: Sensor,
    gains: str = "graphics2raw",
    *,
    lights: Sequence[str] = (),
    global_gains: bool = False,
    seed: int = 0,
) -> Frames:
    """Return the Frames of rendered images (H, W, 3), linear sRGB, exposed.

    gains : one of GAINS; camera needs a sensor with neutrals.
    lights : words, one for each image, in place of drawn gains.
    global_gains : each image has the global gain that its draw has, in place of 1."""
    drawer = Upi(sensor, gains=gains)
    first = seed * len(images)
    draws = [drawer.draw(number) for number in range(first, first + len(images))]
    words = lights or [draw.illuminant for draw in draws]
    digital = [draw.digital_gain if global_gains else 1.0 for draw in draws]
    made = framed(
        (
            draw.sensor.to_camera(image, illuminant=word, digital_gain=gain),
            draw.sensor.illuminant(word).neutral,
        )
        for image, draw, word, gain in zip(images, draws, words, digital, strict=True)
    )
    sensors = tuple(draw.sensor for draw in draws)
    return replace(made, sensors=sensors, scenes=gained(images, digital))


def drawn_global_gains(count: int, sensor: Sensor, seed: int) -> list[float]:
    """Return the global gains that upi() of this seed has for so many images."""
    drawer = Upi(sensor, gains="graphics2raw")
    numbers = range(seed * count, (seed + 1) * count)
    return [drawer.draw(number).digital_gain for number in numbers]
