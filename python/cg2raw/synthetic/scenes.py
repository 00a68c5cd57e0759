# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Procedural scenes: textures, edges, colours, charts, lights; scene-linear Rec.709."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import gaussian_filter

from cg2raw.synthetic.camera import Camera, Plane

# An antialiased render: width of the pixel filter.
PIXEL_FILTER = 0.7
# A colour keeps this share of its mean in its darkest camera channel.
GAMUT_MARGIN = 0.04


def scene(
    rng: Generator, shape: tuple[int, int], camera: Camera
) -> NDArray[np.float32]:
    """Return (H, W, 3): 1 is the white level; 0.3 to 4 % of the pixels are above it."""
    height, width = shape
    image = np.exp(rng.uniform(0.6, 1.1) * texture(rng, shape, 1.1))[..., None]
    image = image * np.exp(
        0.25 * np.stack([texture(rng, shape, 1.6) for _ in range(3)], -1)
    )
    for _ in range(int(110 * np.sqrt(height / 112))):
        leaf(rng, image)
    chart(rng, image)
    stripes(rng, image)
    image *= slope(rng, shape)[..., None]
    lamps(rng, image)
    image = gaussian_filter(image, (PIXEL_FILTER, PIXEL_FILTER, 0))
    image = within_gamut(image, camera)
    brightest = camera.light(image).max(-1)
    above = np.exp(rng.uniform(np.log(0.003), np.log(0.04)))
    exposed: Plane = image / np.quantile(brightest, 1 - above)
    return exposed.astype(np.float32)


def texture(rng: Generator, shape: tuple[int, int], power: float) -> Plane:
    """Return a random field with spectrum 1/f^power, mean 0, sd 1."""
    noise = fft.rfft2(rng.standard_normal(shape))
    v = fft.fftfreq(shape[0])[:, None]
    u = fft.rfftfreq(shape[1])[None]
    radius = np.hypot(u, v)
    radius[0, 0] = 1.0
    spectrum = noise / radius**power
    spectrum[0, 0] = 0.0
    field: Plane = fft.irfft2(spectrum, shape)
    standard: Plane = field / field.std()
    return standard


def color(rng: Generator) -> Plane:
    """Return a reflectance, (3,), from nearly grey to strongly coloured."""
    value = np.exp(rng.uniform(np.log(0.02), np.log(0.9)))
    tinted: Plane = value * np.exp(rng.uniform(0.05, 0.7) * rng.standard_normal(3))
    return tinted


def leaf(rng: Generator, image: Plane) -> None:
    """Cover a polygon, of 3 to 6 random half planes, with a coloured texture."""
    height, width = image.shape[:2]
    size = np.exp(rng.uniform(np.log(3.0), np.log(height / 3.5)))
    y, x = rng.uniform(0, height), rng.uniform(0, width)
    reach = int(2 * size) + 1
    top, left = max(int(y) - reach, 0), max(int(x) - reach, 0)
    part = image[top : int(y) + reach, left : int(x) + reach]
    rows, cols = np.ogrid[: part.shape[0], : part.shape[1]]
    inside = np.hypot(rows + top - y, cols + left - x) < 1.9 * size
    for angle in rng.uniform(0, 2 * np.pi) + np.arange(rng.integers(3, 7)) * 1.3:
        side = (rows + top - y) * np.sin(angle) + (cols + left - x) * np.cos(angle)
        inside &= side < size * rng.uniform(0.5, 1.2)
    grain = np.exp(rng.uniform(0, 0.35) * rng.standard_normal(inside.sum()))
    part[inside] = color(rng) * grain[:, None]


def chart(rng: Generator, image: Plane) -> None:
    """Put 4 x 6 patches somewhere, the last row grey."""
    height, width = image.shape[:2]
    side = max(height // 14, 3)
    top = rng.integers(0, height - 4 * side)
    left = rng.integers(0, width - 6 * side)
    for row in range(4):
        for col in range(6):
            patch = color(rng) if row < 3 else np.full(3, 0.9 * 0.5**col)
            y, x = top + row * side, left + col * side
            image[y : y + side - 1, x : x + side - 1] = patch


def stripes(rng: Generator, image: Plane) -> None:
    """Put a chirp of black and white lines somewhere: all frequencies to Nyquist."""
    height, width = image.shape[:2]
    tall, wide = max(height // 6, 4), max(width // 3, 8)
    top, left = rng.integers(0, height - tall), rng.integers(0, width - wide)
    at = np.arange(wide)
    wave = 0.5 + 0.45 * np.cos(np.pi * at * (0.05 + 0.4 * at / wide))
    part = image[top : top + tall, left : left + wide]
    part[:] = (wave * rng.uniform(0.3, 0.9))[None, :, None]


def slope(rng: Generator, shape: tuple[int, int]) -> Plane:
    """Return an illumination that varies over the frame by some stops."""
    y, x = np.linspace(-1, 1, shape[0])[:, None], np.linspace(-1, 1, shape[1])[None]
    return np.exp2(rng.uniform(-1, 1) * y + rng.uniform(-1, 1) * x)


def lamps(rng: Generator, image: Plane) -> None:
    """Put small bright discs somewhere."""
    height, width = image.shape[:2]
    rows, cols = np.ogrid[:height, :width]
    for _ in range(rng.integers(1, 5)):
        radius = rng.uniform(1.5, height / 20)
        y, x = rng.uniform(0, height), rng.uniform(0, width)
        disc = np.hypot(rows - y, cols - x) < radius
        image[disc] = rng.uniform(2, 8) * np.quantile(image, 0.9)


def within_gamut(image: Plane, camera: Camera) -> Plane:
    """Move colours towards grey until all camera channels are above zero."""
    grey = image.mean(-1, keepdims=True)
    lowest = (image @ camera.balanced_from_scene.T).min(-1, keepdims=True)
    lowest = np.minimum(lowest, image.min(-1, keepdims=True))
    room = (1 - GAMUT_MARGIN) * grey / np.maximum(grey - lowest, 1e-12)
    moved: Plane = grey + np.minimum(room, 1.0) * (image - grey)
    return moved
