# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""An image file as scene-linear Rec.709, and which curve that took."""

from dataclasses import dataclass

import numpy as np
import OpenImageIO as oiio

from cg2raw import _core
from cg2raw.dataset import transfer
from cg2raw.image_file import means_rec709

ENDINGS = (".exr", ".png", ".tif", ".tiff", ".hdr")
# Names of sRGB in OpenImageIO and common configs.
SRGB_NAMES = {
    "srgb",
    "srgb_rec709_scene",
    "srgb_rec709_display",
    "srgb_texture",
    "srgb_tx",
    "srgb - texture",
    "utility - srgb - texture",
}
SIDES = (2, 65535)  # of a RAW file, pixels
ROWS = 256  # that are read at a time; the most that EXR compresses together (DWAB)
INTEGERS = ("uint8", "uint16")


@dataclass
class Image:
    """(H, W, 3) float32, scene-linear Rec.709, and the curve that made it so.

    exposure_time : seconds, as Exif says it; None if it does not."""

    rgb: np.ndarray
    transfer: str
    exposure_time: float | None


def read_image(path):
    """Return the Image of a file. Raises ValueError with the reason in one line."""
    config = oiio.ImageSpec()
    # Alpha is ignored, so colour must not be multiplied by it: PNG would be.
    config.attribute("oiio:UnassociatedAlpha", 1)
    file = oiio.ImageInput.open(path, config)
    if file is None:
        raise ValueError(one_line(oiio.geterror()) or "cannot be read")
    try:
        spec = file.spec()
        first = rgb_channels(spec)
        check_size(spec)
        curve = curve_of(spec)
        rgb = np.empty((spec.height, spec.width, 3), np.float32)
        for row in range(0, spec.height, rows_at_once(spec)):
            part = rgb[row : row + rows_at_once(spec)]
            part[...] = linear(read_rows(file, spec, row, len(part), first), curve)
    finally:
        file.close()
    name = {None: "linear", "srgb": "srgb"}.get(curve, f"g{curve}")
    shot = _core.Shot(exposure_time=spec.get_float_attribute("ExposureTime"))
    return Image(rgb, name, shot.exposure_time)


def rows_at_once(spec):
    """Return how many rows are read at a time, so that no whole copy is made.

    A multiple of what is compressed together: at most 256 rows in EXR, or tiles."""
    return spec.tile_height or ROWS


def read_rows(file, spec, row, count, first):
    """Return (count, W, 3) pixels, floats or integers. Raises ValueError."""
    top, channels = spec.y + row, (first, first + 3)
    kind = oiio.FLOAT if str(spec.format) not in INTEGERS else spec.format
    if spec.tile_height:
        left, right = spec.x, spec.x + spec.width
        box = (left, right, top, top + count, spec.z, spec.z + 1)
        pixels = file.read_tiles(*box, *channels, kind)
    else:
        pixels = file.read_scanlines(top, top + count, spec.z, *channels, kind)
    if pixels is None:
        raise ValueError(one_line(file.geterror()) or "cannot be read")
    return pixels.reshape(count, spec.width, 3)


def one_line(text):
    """Return a library's message in one line, which it may repeat."""
    return " ".join(dict.fromkeys(" ".join(line.split()) for line in text.splitlines()))


def rgb_channels(spec):
    """Return the index of R, which G and B follow. Raises ValueError."""
    names = [name.upper() for name in spec.channelnames]
    for first in range(len(names) - 2):
        if names[first : first + 3] == ["R", "G", "B"]:
            return first
    raise ValueError(
        f"has the channels {', '.join(spec.channelnames)} ({spec.nchannels}): needs "
        "R, G and B in a row"
    )


def check_size(spec):
    """Raise ValueError for a size that no RAW file has."""
    least, most = SIDES
    if not all(least <= side <= most for side in (spec.width, spec.height)):
        raise ValueError(
            f"is {spec.width}x{spec.height} pixels: a RAW file has {least} to {most} "
            "on each side"
        )
    if spec.depth > 1:
        raise ValueError(f"is a volume of {spec.depth} slices, no image")


def curve_of(spec):
    """Return "srgb", an exponent, or None if the pixels are linear. Raises ValueError.

    Integers without a word on their space are sRGB, floats linear."""
    check_primaries(spec)
    space = spec.get_string_attribute("oiio:ColorSpace").lower()
    integer = str(spec.format) in INTEGERS
    if not integer and str(spec.format) not in ("half", "float", "double"):
        raise ValueError(f"has {spec.format} samples: needs 8 or 16 bits, or floats")
    if means_rec709(space) if space else not integer:
        return None
    if integer and (not space or space in SRGB_NAMES):
        return "srgb"
    exponent = spec.get_float_attribute("oiio:Gamma")
    if integer and exponent > 0 and "rec709" in space:
        return round(exponent, 4)
    raise ValueError(
        f'has the colour space "{space}": convert it to scene-linear Rec.709, as by '
        'oiiotool --tocolorspace "lin_rec709"'
    )


def check_primaries(spec):
    """Raise ValueError for other primaries than those of Rec.709."""
    said = spec.getattribute("chromaticities")
    if said is not None and not _core.is_rec709_primaries(said):
        raise ValueError(
            "its chromaticities are not those of Rec.709: convert it to scene-linear "
            "Rec.709, and then --eraseattrib chromaticities"
        )
    profile = spec.get_string_attribute("ICCProfile:profile_description")
    if profile and "srgb" not in profile.lower():
        raise ValueError(
            f'has the ICC profile "{profile}": convert it to sRGB, or to scene-linear '
            "Rec.709"
        )


def linear(pixels, curve):
    """Return float32 light of pixels that are on a curve."""
    if pixels.dtype.kind == "f" and curve is None:
        return pixels
    levels = 2 ** (8 * pixels.itemsize)
    return transfer.table(1.0 if curve is None else curve, levels)[pixels]
