# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Images of any format that OpenImageIO reads, and what they say of themselves."""

import contextlib
from dataclasses import dataclass, field, replace

import numpy as np

from cg2raw import _core

MISSING = "OpenImageIO is not installed for this Python: pip install OpenImageIO"
# What sRGB-encoded files are called by OpenImageIO 2 and 3.
SRGB_NAMES = ("srgb", "srgb_rec709_scene", "srgb_rec709_display", "srgb_tx")


@dataclass(frozen=True)
class Image:
    """Pixels, and what their file says of them."""

    path: str
    pixels: np.ndarray  # (H, W, 3 or 4) float32
    space: str  # the name of its colour space; may be empty
    chromaticities: tuple | None = None  # x, y of red, green, blue, white
    shot: dict = field(default_factory=dict)  # Exif, as write_dng takes it
    linearized: str = ""  # the curve that was undone


def openimageio():
    """Return the module OpenImageIO. Raises ValueError if it is not installed."""
    try:
        import OpenImageIO
    except ImportError:
        raise ValueError(MISSING) from None
    return OpenImageIO


def opened(path):
    """Return the ImageInput of @path, to be closed. Raises ValueError, OSError."""
    oiio = openimageio()
    with open(path, "rb"):  # OpenImageIO's own messages do not tell why it cannot
        pass
    source = oiio.ImageInput.open(path)
    if source is None:
        raise ValueError(f"{path}: {first_line(oiio.geterror())}")
    return source


def read_image(path):
    """Return the Image at @path, its whole display window; black where it has no data.

    Raises ValueError saying what is wrong with the file, OSError."""
    path = str(path)
    with contextlib.closing(opened(path)) as source:
        spec = source.spec()
        check_channels(path, spec)
        if source.seek_subimage(1, 0):
            raise ValueError(
                f"{path}: holds several images: take one out (oiiotool --subimage)"
            )
        source.seek_subimage(0, 0)
        pixels = source.read_image(0, 0, 0, spec.nchannels, "float")
        if pixels is None:
            raise ValueError(f"{path}: {first_line(source.geterror())}")
    chromaticities = spec.getattribute("chromaticities")
    return Image(
        path=path,
        pixels=in_display_window(pixels, spec),
        space=spec.get_string_attribute("oiio:ColorSpace"),
        chromaticities=tuple(chromaticities) if chromaticities else None,
        shot=shot_of(spec),
    )


def check_channels(path, spec):
    """Raise ValueError for an image that is not flat RGB or RGBA."""
    if spec.deep or spec.depth > 1:
        raise ValueError(
            f"{path}: deep and volume images cannot become a DNG: flatten first "
            "(oiiotool --flatten)"
        )
    if not 3 <= spec.nchannels <= 4:
        raise ValueError(
            f"{path}: {spec.nchannels} channels; needs RGB or RGBA (oiiotool --ch "
            "R,G,B)"
        )
    colors = ("red", "green", "blue")
    for name, letter, color in zip(spec.channelnames[:3], "rgb", colors, strict=True):
        last = name.rpartition(".")[2].lower()
        if last and not last.startswith("channel") and last not in (letter, color):
            raise ValueError(
                f'{path}: a channel is named "{name}"; needs R, G, B in this order '
                "(oiiotool --ch R,G,B)"
            )


def in_display_window(pixels, spec):
    """Return pixels of the display window, as oiiotool writes formats without one."""
    width, height = spec.full_width, spec.full_height
    data = (spec.x, spec.y, spec.width, spec.height)
    if data == (spec.full_x, spec.full_y, width, height):
        return pixels
    left, top = spec.x - spec.full_x, spec.y - spec.full_y
    whole = np.zeros((height, width, pixels.shape[2]), np.float32)
    first_row, first_col = max(top, 0), max(left, 0)
    last_row, last_col = min(top + spec.height, height), min(left + spec.width, width)
    if last_row > first_row and last_col > first_col:
        whole[first_row:last_row, first_col:last_col] = pixels[
            first_row - top : last_row - top, first_col - left : last_col - left
        ]
    return whole


def shot_of(spec):
    """Return the Exif of an image, as write_dng takes it."""
    text, number = spec.get_string_attribute, spec.get_float_attribute
    date = text("Exif:DateTimeOriginal") or text("DateTime")
    return {
        "exposure_time": number("ExposureTime"),
        "f_number": number("FNumber"),
        "focal_length": number("Exif:FocalLength"),
        "date_time_original": date,
        "artist": text("Artist"),
        "copyright": text("Copyright"),
        "description": text("ImageDescription"),
        "lens_model": text("Exif:LensModel"),
        "orientation": spec.get_int_attribute("Orientation", 1),
    }


def is_srgb(image):
    """Return whether an image says that it is encoded by the sRGB curve."""
    return image.space.lower() in SRGB_NAMES


def linearized(image):
    """Return an sRGB image as scene-linear Rec.709. Source: IEC 61966-2-1."""
    v = image.pixels[..., :3].astype(np.float64)
    linear = np.where(v <= 0.04045, v / 12.92, ((np.abs(v) + 0.055) / 1.055) ** 2.4)
    pixels = linear.astype(np.float32)
    return replace(image, pixels=pixels, space="", linearized="srgb")


def check_rec709(image):
    """Raise ValueError unless an image is scene-linear Rec.709, and says so."""
    if not means_rec709(image.space):
        remedy = "add --linearize srgb, or, " if is_srgb(image) else ""
        raise ValueError(
            f'{image.path}: colour space "{image.space}" is neither scene-linear '
            f"Rec.709 nor a RAW space: {remedy}if the pixels are linear already, "
            "--iscolorspace lin_rec709; else oiiotool --tocolorspace lin_rec709"
        )
    primaries = image.chromaticities
    if primaries and not _core.is_rec709_primaries(primaries):
        raise ValueError(
            f"{image.path}: its chromaticities are not those of Rec.709: convert it to "
            "scene-linear Rec.709, and then oiiotool --eraseattrib chromaticities"
        )


def means_rec709(space):
    """Return whether a colour space is Rec.709; OCIO's config knows what linear is."""
    if space.lower() in ("linear", "scene_linear"):
        config = openimageio().ColorConfig()
        role = config.getColorSpaceNameByRole("scene_linear")
        return not role or _core.is_rec709_name(role)
    return not space or _core.is_rec709_name(space)


def first_line(text):
    """Return a message's first line."""
    return text.strip().partition("\n")[0] or "cannot be read"
