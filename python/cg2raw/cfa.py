# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mosaic and demosaic for any colour filter array, and the sites of its repeat."""

from numpy.typing import ArrayLike

from cg2raw import _core
from cg2raw.argument_types import TEXT, check_types, thread_count
from cg2raw.arrays import FloatImage, rgb_image, signal_plane


def mosaic(camera: ArrayLike, cfa: str, *, threads: int = 0) -> FloatImage:
    """Return the (H, W) float32 mosaic of camera RGB: one of three values per site.

    camera : (H, W, 3) or (H, W, 4) float; NaN becomes 0.
    cfa : "RGGB", "GRBG", "GBRG", "BGGR", or the 16 or 36 letters of a larger repeat;
        its first letter is the filter of row 0, column 0. "MONO" for a sensor without
        filters: the second of three equal planes.

    Raises ValueError."""
    check_types(TEXT, {"cfa": cfa})
    return _core.mosaic(
        rgb_image(camera, "camera RGB"), cfa, threads=thread_count(threads)
    )


def demosaic(signal: ArrayLike, cfa: str, *, threads: int = 0) -> FloatImage:
    """Return (H, W, 3) float32 camera RGB of a mosaic: what sites lack, interpolated.

    signal : (H, W) float, at least one repeat of the CFA.
    cfa : as of `mosaic`; any pattern, X-Trans too; "MONO" gives three equal planes.

    Normalised convolution with a tent, which is bilinear interpolation for Bayer
    patterns; a constant mosaic stays constant to its edges. What was measured stays.
    Raises ValueError. Source: Knutsson and Westin, CVPR 1993."""
    check_types(TEXT, {"cfa": cfa})
    return _core.demosaic(signal_plane(signal), cfa, threads=thread_count(threads))


def is_mono(cfa: str) -> bool:
    """Return whether a CFA's word says that there are no filters."""
    return cfa.upper() == "MONO"


def sites_of(cfa: str) -> str:
    """Return the letter, R, G or B, of each site of a CFA's repeat, row by row.

    Of a monochrome sensor it is one G: its camera RGB is three times the same, and the
    mosaic takes green's plane. The number of sites is the length of this, and not that
    of the CFA's word."""
    return "G" if is_mono(cfa) else cfa.upper()


def repeat_of(cfa: str) -> int:
    """Return the side of a CFA's square repeat, pixels: 2 of Bayer, 1 of "MONO"."""
    side: float = len(sites_of(cfa)) ** 0.5
    return round(side)
