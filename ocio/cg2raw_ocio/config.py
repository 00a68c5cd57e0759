# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A whole config: scene reference, displays, roles, file rules, RAW spaces."""

import numpy as np
import PyOpenColorIO as ocio

from cg2raw import _core

from . import chain, names
from .spaces import Exposure, group, raw_spaces

DISPLAY, DEVELOPED_VIEW, DATA_VIEW = "sRGB - Display", "White balanced", "Raw"
VERSIONS = ("2.0", "2.1")


def make_config(profiles, illuminants, exposure=None, version="2.1"):
    """Return a validated config with a RAW space for each profile x illuminant.

    profiles : core profiles, in the order of the menu.
    illuminants : words of the illuminant grammar; see illuminant_list.
    exposure : an Exposure; None for the default one.
    version : "2.0" or "2.1", of the config's format.
    Raises ValueError for a version that is not among these, a duplicate, or an
    illuminant that a sensor cannot have."""
    config = base_config(version)
    inactive = []
    for profile in profiles:
        for illuminant in illuminants:
            bounded, unbounded = raw_spaces(profile, illuminant, exposure or Exposure())
            for space in (bounded, unbounded):
                add_space(config, space)
            inactive.append(list(unbounded.getAliases())[0])
    config.setInactiveColorSpaces(", ".join(inactive))
    config.validate()
    return config


def base_config(version="2.1"):
    """Return a config of everything but RAW spaces: linear Rec.709 as scene reference,
    ACES2065-1 and CIE XYZ for interchange, an sRGB display."""
    if version not in VERSIONS:
        raise ValueError(f"config version {version!r} must be 2.0 or 2.1")
    config = ocio.Config()
    config.setVersion(*map(int, version.split(".")))
    config.setName("cg2raw")
    config.setDescription(
        "Camera RAW as colour spaces: convert a linear render to one of RAW/* and "
        "write a .dng (cg2raw)."
    )
    config.setFamilySeparator("/")
    config.setStrictParsingEnabled(True)
    config.setDefaultLumaCoefs([0.2126, 0.7152, 0.0722])
    for space in (*_scene_spaces(), *_display_spaces()):
        add_space(config, space)
    config.addViewTransform(_display_from_scene())
    config.setDefaultViewTransformName("Colorimetric")
    _set_display(config)
    _set_roles(config)
    _set_file_rules(config)
    return config


def add_space(config, space):
    """Add a colour space; ValueError if there is one of that name."""
    # addColorSpace would replace it silently.
    if config.getColorSpace(space.getName()) is not None:
        raise ValueError(f"colour space {space.getName()!r} is asked for twice")
    config.addColorSpace(space)


def _scene_spaces():
    scene = dict(referenceSpace=ocio.REFERENCE_SPACE_SCENE)
    linear = ocio.ColorSpace(
        **scene,
        name=names.SCENE_LINEAR,
        aliases=["lin_rec709_srgb", "lin_rec709", "lin_srgb", "lin_rec709_scene"],
        family="Scene",
        description="Scene-linear, primaries of Rec.709 and sRGB, D65 white: what a "
        "render is expected to be, and the reference of this config.",
        encoding="scene-linear",
        categories=["file-io", "working-space"],
    )
    texture = ocio.ColorSpace(
        **scene,
        name="sRGB Encoded Rec.709 (sRGB)",
        aliases=["srgb_rec709", "srgb_texture", "sRGB", "srgb_tx"],
        family="Scene",
        description="Textures and pictures of 8 bits in sRGB.",
        encoding="sdr-video",
        categories=["file-io"],
        fromReference=_srgb_curve(),
    )
    data = ocio.ColorSpace(
        **scene,
        name=DATA_VIEW,
        family="Utility",
        description="Data that no conversion touches.",
        encoding="data",
        isData=True,
        categories=["file-io"],
    )
    return linear, interchange_space(), texture, data


def interchange_space(name="ACES2065-1", aliases=("aces2065_1", "lin_ap0")):
    """Return ACES2065-1, through which configs of other references are reached."""
    return ocio.ColorSpace(
        referenceSpace=ocio.REFERENCE_SPACE_SCENE,
        name=name,
        aliases=list(aliases),
        family="Scene",
        description="ACES interchange space: linear, AP0 primaries.",
        encoding="scene-linear",
        categories=["file-io"],
        toReference=group(
            [
                ocio.BuiltinTransform("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"),
                chain.matrix(np.linalg.inv(_core.xyz_d65_from_srgb())),
            ]
        ),
    )


def _display_spaces():
    display = dict(referenceSpace=ocio.REFERENCE_SPACE_DISPLAY, family="Display")
    xyz = ocio.ColorSpace(
        **display,
        name="CIE XYZ-D65 - Display-referred",
        aliases=["cie_xyz_d65_display"],
        description="CIE XYZ, D65 white, of what a display shows.",
        encoding="display-linear",
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


def _srgb_curve():
    """Linear -> sRGB encoded. Source: IEC 61966-2-1."""
    curve = ocio.ExponentWithLinearTransform()
    curve.setGamma([2.4, 2.4, 2.4, 1.0])
    curve.setOffset([0.055, 0.055, 0.055, 0.0])
    curve.setDirection(ocio.TRANSFORM_DIR_INVERSE)
    return curve


def _display_from_scene():
    view = ocio.ViewTransform(ocio.REFERENCE_SPACE_SCENE)
    view.setName("Colorimetric")
    view.setDescription("No tone mapping: a RAW space looks as the scene was.")
    view.setTransform(
        chain.matrix(_core.xyz_d65_from_srgb()), ocio.VIEWTRANSFORM_DIR_FROM_REFERENCE
    )
    return view


def _set_display(config):
    config.addDisplayView(
        display=DISPLAY,
        view=DEVELOPED_VIEW,
        viewTransform="Colorimetric",
        displayColorSpaceName=DISPLAY,
    )
    config.addDisplayView(DISPLAY, DATA_VIEW, DATA_VIEW)
    config.setActiveDisplays(DISPLAY)
    config.setActiveViews(f"{DEVELOPED_VIEW}, {DATA_VIEW}")


def _set_roles(config):
    for role, space in {
        "scene_linear": names.SCENE_LINEAR,
        "default": names.SCENE_LINEAR,
        "reference": names.SCENE_LINEAR,
        "rendering": names.SCENE_LINEAR,
        "compositing_linear": names.SCENE_LINEAR,
        "aces_interchange": "ACES2065-1",
        "cie_xyz_d65_interchange": "CIE XYZ-D65 - Display-referred",
        "color_picking": DISPLAY,
        "texture_paint": "sRGB Encoded Rec.709 (sRGB)",
        "matte_paint": "sRGB Encoded Rec.709 (sRGB)",
        "data": DATA_VIEW,
    }.items():
        config.setRole(role, space)


def _set_file_rules(config):
    """A file whose path holds a space's name or alias is in that space; pictures of 8
    bits are sRGB, all else is scene linear."""
    rules = ocio.FileRules()
    rules.insertPathSearchRule(0)
    for extension in ("png", "jpg", "jpeg"):
        rules.insertRule(1, extension, "sRGB Encoded Rec.709 (sRGB)", "*", extension)
    rules.setDefaultRuleColorSpace(names.SCENE_LINEAR)
    config.setFileRules(rules)
