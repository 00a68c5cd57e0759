# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Colour spaces of image files: names, primaries and transfer curves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.io import transfer_curve
from cg2raw.io.transfer_curve import Curve
from cg2raw.oiio.openimageio import openimageio

# Names of sRGB in OpenImageIO 2 and 3, and in common configs.
SRGB_NAMES = {
    "srgb",
    "srgb_rec709_scene",
    "srgb_rec709_display",
    "srgb_texture",
    "srgb_tx",
    "srgb - texture",
    "utility - srgb - texture",
}
RENDERS = ("half", "float", "double")
PICTURES = ("uint8", "uint16")
REC709 = "lin_rec709"  # what messages call it


def is_integer(spec: Any) -> bool:
    """Return whether an image has integers that a curve may encode."""
    return str(spec.format) in PICTURES


def is_srgb(space: str) -> bool:
    """Return whether the name of a space says that the curve of sRGB encodes it."""
    return space.lower() in SRGB_NAMES


def means_rec709(space: str) -> bool:
    """Return whether a colour space is Rec.709; OCIO's config knows what linear is."""
    if space.lower() in ("linear", "scene_linear"):
        role = openimageio().ColorConfig().getColorSpaceNameByRole("scene_linear")
        return not role or _core.is_rec709_name(role)
    return not space or _core.is_rec709_name(space)


def check_primaries(chromaticities: Sequence[float], space: str) -> None:
    """Raise ValueError for other primaries than Rec.709's, of a space nobody stated."""
    version = openimageio().VERSION
    _core.require_rec709_primaries(chromaticities, space, version, REC709)


def curve_of(spec: Any, undo: str | None) -> Curve | None:
    """Return the curve to undo in an image: "srgb", an exponent, or None.

    undo : as read_image has it. Raises ValueError."""
    space = spec.get_string_attribute("oiio:ColorSpace")
    if undo is None:
        return None
    if undo == "srgb":
        return "srgb" if is_srgb(space) else None
    return stated_curve(spec, space.lower())


def stated_curve(spec: Any, space: str) -> Curve | None:
    """Return the curve that a file states, sRGB's for integers without a word.

    Raises ValueError unless the pixels are Rec.709 then."""
    said = spec.getattribute("chromaticities")
    if said is not None:
        check_primaries(said, spec.get_string_attribute("oiio:ColorSpace"))
    profile = spec.get_string_attribute("ICCProfile:profile_description")
    if profile and "srgb" not in profile.lower():
        raise ValueError(
            f'has the ICC profile "{profile}": convert it to sRGB, or to scene-linear '
            "Rec.709"
        )
    integer = is_integer(spec)
    if not integer and str(spec.format) not in RENDERS:
        raise ValueError(f"has {spec.format} samples: needs 8 or 16 bits, or floats")
    if means_rec709(space) if space else not integer:
        return None if not integer else 1.0
    if integer and (not space or is_srgb(space)):
        return "srgb"
    exponent = float(spec.get_float_attribute("oiio:Gamma"))
    if integer and exponent > 0 and "rec709" in space:
        return round(exponent, 4)
    raise ValueError(
        f'has the colour space "{space}": convert it to scene-linear Rec.709, as by '
        f'oiiotool --tocolorspace "{REC709}"'
    )


def name_of(curve: Curve | None) -> str:
    """Return what a curve is called: "srgb", "g2.2", or nothing."""
    if curve is None or curve == 1.0:
        return ""
    return curve if isinstance(curve, str) else f"g{curve}"


def light_of(pixels: NDArray[Any], curve: Curve | None) -> FloatImage:
    """Return float32 light of pixels on a curve: floats (sRGB's alone), or integers."""
    if curve is None:
        return pixels.astype(np.float32, copy=False)
    if pixels.dtype.kind == "f":
        return transfer_curve.srgb_light(pixels)
    table = transfer_curve.table(curve, 2 ** (8 * pixels.itemsize))
    light: FloatImage = table[pixels]
    return light
