# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The spaces that every config has, whatever its sensors."""

from collections.abc import Sequence

import numpy as np
import PyOpenColorIO as ocio

from cg2raw import _core

from . import chain, names
from .chain import Op, Space
from .spaces import group

DISPLAY, TEXTURE = "sRGB - Display", "sRGB Encoded Rec.709 (sRGB)"
# As Blender has it. Not "Raw": the first file rule would find that in strawberry.png.
DATA = "Non-Color"


def scene_spaces() -> tuple[Space, ...]:
    """Linear spaces of the scene, and ACES's for grading."""
    scene = dict(referenceSpace=ocio.REFERENCE_SPACE_SCENE)
    linear = ocio.ColorSpace(
        **scene,
        name=names.SCENE_LINEAR,
        aliases=[
            "lin_rec709_srgb",
            "lin_rec709",
            "lin_srgb",
            "lin_rec709_scene",
            "Linear Rec.709",  # of Blender 4 and 5
        ],
        family="Scene",
        description="Scene-linear, primaries of Rec.709 and sRGB, D65 white: what a "
        "render is expected to be, and the reference of this config.",
        encoding="scene-linear",
        categories=["file-io", "working-space"],
    )
    acescg = _aces_space(
        "ACEScg",
        ["lin_ap1", "lin_ap1_scene"],
        "Linear, AP1 primaries: renders and textures of ACES productions.",
        ["UTILITY - ACES-AP1_to_CIE-XYZ-D65_BFD"],
    )
    acescct = _aces_space(
        "ACEScct",
        ["acescct_ap1"],
        "ACEScct: logarithmic with a toe, AP1 primaries, for grading.",
        ["ACEScct_to_ACES2065-1", "UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"],
        encoding="log",
    )
    return linear, interchange_space(), acescg, acescct


def interchange_space(name: str = "ACES2065-1") -> Space:
    """Return ACES2065-1, through which configs of other references are reached."""
    return _aces_space(
        name,
        ["aces2065_1", "lin_ap0", "lin_ap0_scene"],
        "ACES interchange space: linear, AP0 primaries.",
        ["UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"],
    )


def picture_spaces() -> tuple[Space, ...]:
    """Pictures of 8 bits, and data."""
    scene = dict(referenceSpace=ocio.REFERENCE_SPACE_SCENE)
    texture = ocio.ColorSpace(
        **scene,
        name=TEXTURE,
        aliases=["srgb_rec709", "srgb_texture", "sRGB", "srgb_tx"],
        family="Scene",
        description="Textures and pictures of 8 bits in sRGB.",
        encoding="sdr-video",
        categories=["file-io"],
        fromReference=_srgb_curve(),
    )
    data = ocio.ColorSpace(
        **scene,
        name=DATA,
        family="Utility",
        description="Data that no conversion touches.",
        encoding="data",
        isData=True,
        categories=["file-io"],
    )
    return texture, data


def _aces_space(
    name: str,
    aliases: list[str],
    description: str,
    xyz_d65_from_it: Sequence[str],
    encoding: str = "scene-linear",
) -> Space:
    return ocio.ColorSpace(
        referenceSpace=ocio.REFERENCE_SPACE_SCENE,
        name=name,
        aliases=aliases,
        family="Scene",
        description=description,
        encoding=encoding,
        categories=["file-io"],
        toReference=group(
            [
                *map(ocio.BuiltinTransform, xyz_d65_from_it),
                chain.matrix(np.linalg.inv(_core.xyz_d65_from_srgb())),
            ]
        ),
    )


def display_spaces() -> tuple[Space, ...]:
    """CIE XYZ for interchange, and an sRGB monitor."""
    display = dict(referenceSpace=ocio.REFERENCE_SPACE_DISPLAY, family="Display")
    xyz = ocio.ColorSpace(
        **display,
        name="CIE XYZ-D65 - Display-referred",
        aliases=["cie_xyz_d65_display"],
        description="CIE XYZ, D65 white, of what a display shows.",
        encoding="display-linear",
        categories=["file-io"],
    )
    srgb = ocio.ColorSpace(
        **display,
        name=DISPLAY,
        aliases=["srgb_display"],
        description="sRGB monitor: piecewise curve, D65 white.",
        encoding="sdr-video",
        categories=["file-io"],
        fromReference=group(
            [chain.matrix(np.linalg.inv(_core.xyz_d65_from_srgb())), _srgb_curve()]
        ),
    )
    return xyz, srgb


def _srgb_curve() -> Op:
    """Linear -> sRGB encoded. Source: IEC 61966-2-1."""
    curve = ocio.ExponentWithLinearTransform()
    curve.setGamma([2.4, 2.4, 2.4, 1.0])
    curve.setOffset([0.055, 0.055, 0.055, 0.0])
    curve.setDirection(ocio.TRANSFORM_DIR_INVERSE)
    return curve
