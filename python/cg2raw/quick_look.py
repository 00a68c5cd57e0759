# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A DNG as a picture: LibRaw's development with the file's own white balance."""

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.interrupts import scratch_folder
from cg2raw.io.atomic_file import FilePath, utf8_path, write_atomically
from cg2raw.io.libraw import opened
from cg2raw.oiio.openimageio import one_line, openimageio

# Below this LibRaw has no whole tile for its X-Trans demosaicing, and says
# "Input/output error". Measured with LibRaw 0.22: 512 x 512 is the least.
LEAST_X_TRANS = 512


def develop(
    path: FilePath,
    *,
    bits: int = 8,
    half: bool = False,
    brightness: float = 1.0,
    auto_bright: bool = False,
) -> NDArray[Any]:
    """Return the (H, W, 3) uint8 or uint16 sRGB picture of a DNG or RAW file.

    half : one pixel of each 2x2, without demosaicing.
    brightness : multiplies the linear picture.
    auto_bright : stretch until 1 % of the pixels clip, instead of the file's white.
    Raises ValueError that says what LibRaw cannot do, OSError."""
    import rawpy

    with opened(path) as raw:
        refuse_small_x_trans(path, raw, half)
        picture: NDArray[Any] = raw.postprocess(
            use_camera_wb=True,
            half_size=half,
            no_auto_bright=not auto_bright,
            bright=brightness,
            output_bps=bits,
            output_color=rawpy.ColorSpace.sRGB,
            gamma=(2.4, 12.92),  # IEC 61966-2-1
        )
    # Of a monochrome sensor there is one channel.
    return np.repeat(picture, 3, axis=2) if picture.shape[2] == 1 else picture


def refuse_small_x_trans(path: FilePath, raw: Any, half: bool) -> None:
    """Raise ValueError for an X-Trans file that LibRaw would call an I/O error."""
    pattern = raw.raw_pattern
    sizes = raw.sizes
    least = min(sizes.width, sizes.height)
    if pattern is None or pattern.shape != (6, 6) or half or least >= LEAST_X_TRANS:
        return
    raise ValueError(
        f"{path}: {sizes.width}x{sizes.height} of an X-Trans sensor: LibRaw demosaics "
        f"these from {LEAST_X_TRANS}x{LEAST_X_TRANS} pixels on; render it larger, or "
        "use --half"
    )


def write_png(path: FilePath, picture: NDArray[Any]) -> None:
    """Write an (H, W, 3) uint8 or uint16 sRGB picture as PNG, whole or not at all.

    Raises ValueError, OSError."""
    oiio = openimageio()
    height, width, channels = picture.shape
    kind = "uint16" if picture.dtype == np.uint16 else "uint8"
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec.attribute("oiio:ColorSpace", "sRGB")
    with scratch_folder("cg2raw-render-") as folder:
        part = os.path.join(folder, "picture.png")
        with utf8_path(part) as way:
            out = oiio.ImageOutput.create(way)
            if not (
                out and out.open(way, spec) and out.write_image(picture) and out.close()
            ):
                message = out.geterror() if out else oiio.geterror()
                raise ValueError(f"{path}: cannot be written: {one_line(message)}")
        with open(part, "rb") as file:
            data = file.read()
    write_atomically(path, data)
