# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source ours: cg2raw's RAW of rendered images, by published matrices.

Its lights are those given, or drawn from the Gaussian of the neutrals that the sensor's
profile has, as published; or near those neutrals themselves."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw import Sensor
from studies.sources.frames import Frames, Image, framed

CONVENTIONS = ("dng", "paper", "spectral")


def ours(
    images: Sequence[Image],
    sensor: Sensor,
    convention: str = "dng",
    *,
    lights: Sequence[str] = (),
    gains: Sequence[float] = (),
    seed: int = 0,
) -> Frames:
    """Return the Frames of rendered images (H, W, 3), linear sRGB, exposed.

    convention : one of CONVENTIONS; spectral needs a sensor with sensitivities.
    lights : words, one for each image; by default drawn, the same of the same @seed.
    gains : digital gains, one for each image; by default 1."""
    words = lights or drawn(len(images), seed)
    made = framed(
        (
            sensor.to_camera(
                image, illuminant=word, convention=convention, digital_gain=gain
            ),
            sensor.illuminant(word).neutral,
        )
        for image, word, gain in zip(
            images, words, gains or [1.0] * len(images), strict=True
        )
    )
    return replace(made, scenes=gained(images, gains))


def gained(images: Sequence[Image], gains: Sequence[float]) -> tuple[Image, ...]:
    """Return images times their gains, if there are any."""
    if not gains:
        return tuple(images)
    pairs = zip(images, gains, strict=True)
    return tuple(image * np.float32(gain) for image, gain in pairs)


def drawn(count: int, seed: int, word: str = "sample") -> list[str]:
    """Return words of lights drawn from a profile's neutrals; seeds share none.

    word : sample, of their Gaussian, or measured, near themselves."""
    return [f"{word}:{seed * count + number}" for number in range(count)]
