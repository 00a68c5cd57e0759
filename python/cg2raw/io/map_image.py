# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Maps as PNGs with a palette, for pages."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.report_page import Image

MISSING = "the page needs Pillow: pip install 'cg2raw[diagnose]'"
STEPS = 33  # colours: few, so that it packs well
MASKED = (128, 128, 128)
Color = tuple[int, int, int]
# From below over white to above, and from low to high; distinct for all common colour
# vision. Sources: C. Brewer, colorbrewer2.org (RdBu); S. van der Walt, N. Smith, A
# better default colormap for Matplotlib, SciPy 2015 (viridis).
DIVERGING: Sequence[Color] = (
    (5, 48, 97),
    (67, 147, 195),
    (247, 247, 247),
    (214, 96, 77),
    (103, 0, 31),
)
SEQUENTIAL: Sequence[Color] = (
    (68, 1, 84),
    (59, 82, 139),
    (33, 145, 140),
    (94, 201, 98),
    (253, 231, 37),
)

Pixels = NDArray[np.floating]


def map_image(
    values: Pixels, ends: tuple[float, float], alt: str, colors: Sequence[Color]
) -> Image:
    """Return (h, w) values as a picture: colors from one end to the other, beyond which
    they stay; grey where nothing is known. Raises ValueError if Pillow is missing."""
    low, high = ends
    known = np.isfinite(values)
    share = (np.where(known, values, low) - low) / max(high - low, 1e-300)
    index = np.rint(np.clip(share, 0, 1) * (STEPS - 1))
    places, steps = np.linspace(0, 1, len(colors)), np.linspace(0, 1, STEPS)
    each = [np.interp(steps, places, one) for one in np.transpose(np.array(colors))]
    palette = [*np.rint(np.transpose(each)).astype(int).ravel().tolist(), *MASKED]
    codes = np.where(known, index, STEPS).astype(np.uint8)
    return png_image(codes, alt, bytes(palette))


def png_image(
    pixels: NDArray[np.uint8], alt: str, palette: bytes | None = None
) -> Image:
    """Return (h, w, 3) pixels, or (h, w) indices into a palette, as a PNG. Raises
    ValueError if Pillow is missing."""
    try:
        from PIL import Image as Pillow
    except ImportError:
        raise ValueError(MISSING) from None
    picture = Pillow.fromarray(pixels)
    if palette is not None:
        picture = picture.convert("P")
        picture.putpalette(palette)
    png = io.BytesIO()
    picture.save(png, "PNG", optimize=True)
    height, width = pixels.shape[:2]
    return Image(png.getvalue(), width, height, alt)
