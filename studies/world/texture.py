# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random textures whose amplitude falls with frequency, as those of photographs do."""

import numpy as np

from studies.world.colorimetry import Array


def texture(rng: np.random.Generator, shape: tuple[int, int], power: float) -> Array:
    """Return a field of @shape, mean 0, sd 1, of amplitude 1 / frequency^power."""
    height, width = shape
    down = np.fft.fftfreq(height)[:, None] * height
    across = np.fft.rfftfreq(width)[None] * width
    amplitude = np.maximum(1.0, np.hypot(down, across)) ** -power
    phase = np.exp(2j * np.pi * rng.random(amplitude.shape))
    field = np.fft.irfft2(amplitude * phase, shape)
    return np.asarray((field - field.mean()) / field.std())
