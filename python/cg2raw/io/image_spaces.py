# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Colour spaces of image files: names, primaries and transfer curves."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cg2raw import _core
from cg2raw.oiio.openimageio import openimageio

REC709 = "lin_rec709"  # what messages call it
# What files say of their pixels' encoding by other means than the name of a space.
OTHER_STATEMENTS = (
    "chromaticities",
    "colorInteropID",
    "ICCProfile:profile_description",
    "dpx:Transfer",
)


@dataclass(frozen=True)
class Remedies:
    """How a user says what a file does not, for messages.

    linearize : undo the curve of sRGB. is_linear : the pixels are linear light."""

    linearize: str
    is_linear: str


COMMAND = Remedies("--linearize srgb", f"--iscolorspace {REC709}")


def is_integer(spec: Any) -> bool:
    """Return whether an image has whole numbers, which a curve may encode."""
    return _core.levels_of(str(spec.format)) != 0


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


def state(spec: Any, space: str) -> None:
    """Make an image be of a colour space, whatever its file says."""
    spec.attribute("oiio:ColorSpace", space)
    for name in OTHER_STATEMENTS:
        spec.erase_attribute(name)


def encoding_of(spec: Any, takes_raw: bool) -> _core.StatedEncoding:
    """Return what an image says of its encoding. Raises ValueError.

    takes_raw : RAW pixels are right, too."""
    text = spec.get_string_attribute
    space = _core.space_of_file(text("oiio:ColorSpace"), text("colorInteropID"))
    return _core.StatedEncoding(
        space,
        is_rec709=means_rec709(space),
        is_raw=takes_raw and _core.raw_space_from_name(space) is not None,
        samples=str(spec.format),
        icc_profile=text("ICCProfile:profile_description"),
        transfer=text("dpx:Transfer"),
        gamma=float(spec.get_float_attribute("oiio:Gamma")),
    )


def curve_of(said: _core.StatedEncoding, undo: str, remedies: Remedies) -> _core.Curve:
    """Return the curve to undo. undo : a word of Undo in encoding.h.

    Raises ValueError unless the pixels are Rec.709, or RAW, then."""
    convert = f"oiiotool --tocolorspace {REC709}"
    if not said.space:  # oiiotool takes it for linear
        convert = f"oiiotool --iscolorspace NAME --tocolorspace {REC709}"
    words = remedies.linearize, remedies.is_linear, convert
    return _core.curve_of(said, undo, *words)


def decoder_of(
    spec: Any, layer: _core.SceneLayer, curve: _core.Curve | None
) -> _core.Decoder:
    """Return the way from the numbers of a layer to light."""
    alpha = "none"
    if layer.alpha >= 0:
        straight = spec.get_int_attribute("oiio:UnassociatedAlpha")
        alpha = "unassociated" if straight else "associated"
    return _core.Decoder(curve, alpha, _core.levels_of(str(spec.format)))
