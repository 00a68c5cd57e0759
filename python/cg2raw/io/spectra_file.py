# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Images whose channels are a spectrum, as cg2raw.spectra takes them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.io import image_facts
from cg2raw.io.atomic_file import FilePath
from cg2raw.io.image_file import (
    Image,
    check_size,
    opened,
    visible_rows,
)
from cg2raw.oiio.openimageio import openimageio
from cg2raw.spectra import Rows, Statistic


@dataclass(frozen=True)
class SpectraFile:
    """A file of spectra, and what it says of them.

    bins : the channels that are a spectrum. white : cd/m2 of white, where the file
    states it."""

    path: str
    spec: Any  # OpenImageIO's ImageSpec
    bins: _core.SpectralChannels
    white: float | None = None

    @property
    def light(self) -> Rows | None:
        """Return the spectrum that an attribute "illuminant" states, None if none does.

        Raises ValueError."""
        return _core.stated_light(image_facts.facts([self.spec]))

    def rows(self) -> Iterator[tuple[slice, slice, FloatImage]]:
        """Yield (rows, cols, (h, w, N) spectra) of the display window.

        Raises ValueError, OSError."""
        channels = self.bins.channels
        with opened(self.path) as source:
            kind = openimageio().FLOAT
            found = visible_rows(self.path, source, self.spec, channels, kind)
            for rows, cols, part in found:
                yield rows, cols, np.ascontiguousarray(part, np.float32)

    def statistic(self, statistic: Statistic) -> NDArray[np.float64]:
        """Return (N,) a statistic of all pixels in each bin."""
        return statistic.of(part for _, _, part in self.rows())

    def image(self, pixels: FloatImage) -> Image:
        """Return the Image of pixels that were made of the spectra."""
        shot = _core.stated_shot(image_facts.facts([self.spec]))
        return Image(self.path, pixels, shot)

    def empty(self, depth: int) -> FloatImage:
        """Return (H, W, depth) zeros of the display window. Raises ValueError."""
        check_size(self.path, self.spec)
        size = self.spec.full_height, self.spec.full_width
        return np.zeros((*size, depth), np.float32)


def spectra_in(path: FilePath) -> SpectraFile | None:
    """Return the SpectraFile of the first image at @path, None if it has no spectra.

    Raises ValueError, OSError."""
    with opened(path) as source:
        spec = source.spec()
    facts = image_facts.facts([spec])
    try:
        bins = _core.spectral_bins(facts)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if bins is None:
        return None
    return SpectraFile(str(path), spec, bins, _core.stated_white(facts))


def read_camera(
    file: SpectraFile, response: _core.SpectralResponse
) -> tuple[FloatImage, float]:
    """Return ((H, W, 3) camera RGB, the share of energy that the sensor does not see).

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
    return pixels, unseen


def read_spectra(file: SpectraFile) -> Image:
    """Return the Image of (H, W, N) spectra, all in memory. Raises ValueError,
    OSError."""
    pixels = file.empty(len(file.bins.wavelengths))
    for rows, cols, part in file.rows():
        pixels[rows, cols] = part
    return file.image(pixels)
