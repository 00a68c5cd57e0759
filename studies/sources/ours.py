# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source ours: cg2raw's RAW of rendered images, by published matrices.

Its lights are those given, or drawn from the Gaussian of the neutrals that the sensor's
profile has, as published; or near those neutrals themselves."""

from collections.abc import Sequence
from dataclasses import replace

from cg2raw import Sensor
from studies.sources.frames import Frames, Image, framed

CONVENTIONS = ("dng", "paper", "spectral")


def ours(
    images: Sequence[Image],
    sensor: Sensor,
    convention: str = "dng",
    *,
    lights: Sequence[str] = (),
    seed: int = 0,
) -> Frames:
    """Return the Frames of rendered images (H, W, 3), linear sRGB, exposed.

    convention : one of CONVENTIONS; spectral needs a sensor with sensitivities.
    lights : words, one for each image; by default drawn, the same of the same @seed.
    Their own exposure is that of the renders: gain 1."""
    words = lights or drawn(len(images), seed)
    made = framed(
        (
            sensor.to_camera(image, illuminant=word, convention=convention),
            sensor.illuminant(word).neutral,
        )
        for image, word in zip(images, words, strict=True)
    )
    return replace(made, own=tuple(made.images))


def drawn(count: int, seed: int, word: str = "sample") -> list[str]:
    """Return words of lights drawn from a profile's neutrals; seeds share none.

    word : sample, of their Gaussian, or measured, near themselves."""
    return [f"{word}:{seed * count + number}" for number in range(count)]
