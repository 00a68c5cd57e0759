# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Images whose channels are a spectrum, as cg2raw.spectra takes them."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.io.atomic_file import FilePath
from cg2raw.io.image_file import Image, check_size, opened, shot_of, visible_rows
from cg2raw.spectra import Rows, Statistic


@dataclass(frozen=True)
class SpectraFile:
    """A file of spectra, and what it says of them.

    bins : the channels that are a spectrum. white : cd/m2 of white, and light : the
    light's spectrum, [(nm, power)], where the file states them."""

    path: str
    bins: _core.SpectralChannels
    white: float | None
    light: Rows | None

    def rows(self) -> Iterator[tuple[slice, slice, FloatImage]]:
        """Yield (rows, cols, (h, w, N) spectra) of the display window.

        Raises ValueError, OSError."""
        with contextlib.closing(opened(self.path)) as source:
            spec = source.spec()
            check_size(self.path, spec)
            found = visible_rows(self.path, source, spec, self.bins.channels, None)
            for rows, cols, part in found:
                yield rows, cols, np.ascontiguousarray(part, np.float32)

    def statistic(self, statistic: Statistic) -> NDArray[np.float64]:
        """Return (N,) a statistic of all pixels in each bin."""
        return statistic.of(part for _, _, part in self.rows())

    def image(self, pixels: FloatImage) -> Image:
        """Return the Image of pixels that were made of the spectra."""
        with contextlib.closing(opened(self.path)) as source:
            spec = source.spec()
            code = spec.get_string_attribute("smpte:TimeCode")
            return Image(self.path, pixels, "", shot=shot_of(spec), time_code=code)

    def empty(self, depth: int) -> FloatImage:
        """Return (H, W, depth) zeros of the display window."""
        with contextlib.closing(opened(self.path)) as source:
            spec = source.spec()
            check_size(self.path, spec)
            return np.zeros((spec.full_height, spec.full_width, depth), np.float32)


def spectra_in(path: FilePath) -> SpectraFile | None:
    """Return the SpectraFile of the first image at @path, None if it has no spectra.

    Raises ValueError, OSError."""
    with contextlib.closing(opened(path)) as source:
        spec = source.spec()
    names = spec.channelnames
    said = {name: spec.getattribute(f"{name}.wavelength") for name in names}
    stated = {name: float(metres) for name, metres in said.items() if metres}
    texts = {name: spec.getattribute(name) for name in names}
    responses = {name: text for name, text in texts.items() if isinstance(text, str)}
    try:
        bins = _core.spectral_channels(names, stated, responses)
        if bins is None:
            return None
        light = light_in(spec)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    whites = map(spec.getattribute, ("whiteLuminance", "openexr:whiteLuminance"))
    white = next((float(value) for value in whites if value), None)
    return SpectraFile(str(path), bins, white, light)


def light_in(spec: Any) -> Rows | None:
    """Return the spectrum that an attribute "illuminant" states; None if none does."""
    texts = map(spec.getattribute, ("illuminant", "openexr:illuminant"))
    text = next((text for text in texts if isinstance(text, str)), None)
    if text is None:
        return None
    try:
        return _core.spectrum_from_text(text)
    except ValueError as error:
        raise ValueError(
            f"attribute illuminant, the light's spectrum: {error}"
        ) from None


def read_camera(
    file: SpectraFile, response: _core.SpectralResponse
) -> tuple[Image, float]:
    """Return (Image of camera RGB, the share of energy that the sensor does not see).

    A few rows of spectra are held at a time. The share is of all pixels and bins whose
    wavelengths the sensitivities do not reach; nan where a pixel is not finite.
    Raises ValueError, OSError."""
    pixels = file.empty(3)
    sums = np.zeros(len(file.bins.wavelengths))
    for rows, cols, part in file.rows():
        pixels[rows, cols] = response.to_camera(part)
        sums += part.sum(axis=(0, 1), dtype=np.float64)
    of_bins, reached = sums @ response.widths
    unseen = float(1.0 - reached / of_bins) if of_bins > 0 else 0.0
    return file.image(pixels), unseen


def read_spectra(file: SpectraFile) -> Image:
    """Return the Image of (H, W, N) spectra, all in memory. Raises ValueError,
    OSError."""
    pixels = file.empty(len(file.bins.wavelengths))
    for rows, cols, part in file.rows():
        pixels[rows, cols] = part
    return file.image(pixels)
