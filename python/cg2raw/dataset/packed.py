# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A Bayer mosaic as four planes of half its size, for training."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.oiio.openimageio import openimageio


def packed(
    raw: RawImage,
    cfa: str,
    black_level: Sequence[float],
    white_level: float,
    element_type: str,
) -> NDArray[Any]:
    """Return (4, H // 2, W // 2): planes R, G1, G2, B, 0..1 above black.

    raw : (H, W) DN; an odd last row or column is dropped. cfa : "RGGB" or another
    phase; G1 is the green beside red, G2 that beside blue. black_level : (4,) DN per
    site, row by row.
    element_type : "float32", below 0 where noise is, or "uint16", 65535 at white."""
    height, width = raw.shape[0] // 2 * 2, raw.shape[1] // 2 * 2
    planes = np.empty((4, height // 2, width // 2), element_type)
    for plane, site in zip(planes, sites(cfa), strict=True):
        row, col = divmod(site, 2)
        black = black_level[site]
        signal = raw[row:height:2, col:width:2].astype(np.float32)
        signal -= np.float32(black)
        signal /= np.float32(white_level - black)
        if element_type == "uint16":
            signal = np.rint(np.clip(signal, 0, 1) * np.float32(65535))
        plane[...] = signal
    return planes


def sites(cfa: str) -> tuple[int, int, int, int]:
    """Return the sites, row by row, of R, G1, G2 and B in a 2x2 CFA."""
    red, blue = cfa.index("R"), cfa.index("B")
    beside_red, beside_blue = red ^ 1, blue ^ 1  # the other column of the same row
    return red, beside_red, beside_blue, blue


def write_npy(path: str, planes: NDArray[Any]) -> None:
    """Write planes as .npy. Raises OSError."""
    with open(path, "wb") as stream:
        np.save(stream, planes, allow_pickle=False)


def write_exr(path: str, planes: NDArray[Any]) -> None:
    """Write (4, h, w) float32 planes as the channels R, G1, G2, B. Raises OSError."""
    oiio = openimageio()
    _, height, width = planes.shape
    spec = oiio.ImageSpec(width, height, 4, "float")
    spec.channelnames = ("R", "G1", "G2", "B")
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", "1970:01:01 00:00:00")  # else now: other bytes each time
    file = oiio.ImageOutput.create(path)
    pixels = np.ascontiguousarray(np.moveaxis(planes, 0, -1))
    if file is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    if not (file.open(path, spec) and file.write_image(pixels) and file.close()):
        raise OSError(f"{path}: {file.geterror()}")
