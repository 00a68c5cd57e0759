# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral images: what a sensor sees of the radiance at each wavelength."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.exposure import Light, illuminant_word
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor


def camera_from_spectra(
    sensor: Sensor,
    spectra: ArrayLike,
    wavelengths: Sequence[float],
    *,
    illuminant: Light,
    white: float,
    threads: int = 0,
) -> FloatImage:
    """Return (H, W, 3) float32 camera RGB of a spectral image, white at 1, not clipped.

    sensor : Sensor with spectral_sensitivities.
    spectra : (H, W, N) float, spectral radiance in W/(m2 sr nm). Each bin is a box that
        reaches half way to its neighbours.
    wavelengths : (N,) centres of the bins, nm, rising.
    illuminant : word or Illuminant whose spectrum white has.
    white : cd/m2 of a perfect diffuser under that light, at which the sensor's most
        sensitive channel is 1.

    Raises ValueError."""
    centres = np.asarray(wavelengths, np.float64)
    if centres.ndim != 1 or len(centres) < 2 or not np.all(np.diff(centres) > 0.0):
        raise ValueError("wavelengths must be two or more numbers in nm that rise")
    light = sensor.illuminant(illuminant_word(illuminant, sensor.id))
    response = _core.SpectralResponse(sensor.profile, light, centres.tolist(), white)
    image = np.asarray(spectra)
    if image.dtype.kind != "f":
        raise ValueError(f"spectra must be float, not {image.dtype}")
    return response.to_camera(image.astype(np.float32, copy=False), threads=threads)


def simulate_spectra(
    sensor: Sensor,
    spectra: ArrayLike,
    wavelengths: Sequence[float],
    *,
    illuminant: Light,
    white: float,
    threads: int = 0,
    **run: Any,
) -> RawFrame:
    """Return the RAW frame, (H, W) uint16 DN, of a spectral image, as the plugin does.

    run : fields of cg2raw.Run but for convention, highlights, digital_gain and
        camera_input; all else as of camera_from_spectra. Raises ValueError."""
    camera = camera_from_spectra(
        sensor,
        spectra,
        wavelengths,
        illuminant=illuminant,
        white=white,
        threads=threads,
    )
    word = illuminant_word(illuminant, sensor.id)
    run["illuminant"] = _core.seen_by_sensitivities(sensor.profile, word)
    fixed = {"convention": "sensor", "camera_input": True}
    return sensor.simulate(camera, threads=threads, **fixed, **run)
