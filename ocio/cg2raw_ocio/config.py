# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A whole config: scene reference, displays, roles, file rules, RAW spaces."""

import re
from collections.abc import Sequence
from typing import Any

import PyOpenColorIO as ocio

from cg2raw import _core

from . import chain, color_effects, names
from .fixed_spaces import (
    DATA,
    DISPLAY,
    TEXTURE,
    display_spaces,
    picture_spaces,
    scene_spaces,
)
from .spaces import Exposure, all_raw_spaces

DEVELOPED_VIEW, DATA_VIEW = "White balanced", "Raw"
VERSIONS = ("2.0", "2.1")
# The line of a space whose last alias is its interop ID.
INTEROP_ALIAS = re.compile(r"^    aliases: \[.*(cg2raw:\w+)\]\n", re.MULTILINE)


def make_config(
    profiles: Sequence[_core.SensorProfile],
    illuminants: Sequence[str],
    exposure: Exposure | None = None,
    version: str = "2.1",
    folder: str | None = None,
) -> chain.Config:
    """Return a validated config with a RAW space for each profile x illuminant.

    profiles : core profiles, in the order of the menu.
    illuminants : words of the illuminant grammar; see illuminant_list.
    exposure : an Exposure; None for the default one.
    version : "2.0" or "2.1", of the config's format.
    folder : where table_files() lie, relative to the config, if the exposure has_table.
    Raises ValueError for a version that is not among these, a duplicate, or an
    illuminant that a sensor cannot have."""
    config = base_config(version)
    if folder is not None:
        config.setSearchPath(folder)
    spaces, inactive = all_raw_spaces(profiles, illuminants, exposure)
    for space in spaces:
        add_space(config, space)
    config.setDescription(config.getDescription() + left_to_the_writer(profiles))
    config.setInactiveColorSpaces(", ".join(inactive))
    config.validate()
    return config


def config_text(config: chain.Config) -> str:
    """Return a config as the text of an .ocio file that loads fast.

    OpenColorIO writes the list of inactive spaces before the spaces, and then goes
    through all of it for each space it reads: 439 spaces take 3.3 s. After the spaces
    the list is applied once: 0.4 s. The config is the same."""
    key = "inactive_colorspaces:"
    text = config.serialize()
    if not hasattr(ocio.ColorSpace, "setInteropID"):  # before OpenColorIO 2.5
        text = INTEROP_ALIAS.sub(r"\g<0>    interop_id: \1\n", text)
    lines = text.splitlines(keepends=True)
    late = [line for line in lines if line.startswith(key)]
    return "".join(line for line in lines if line not in late) + "".join(late)


def base_config(version: str = "2.1") -> chain.Config:
    """Return a config of everything but RAW spaces: linear Rec.709 as scene reference,
    ACES2065-1 and CIE XYZ for interchange, an sRGB display."""
    if version not in VERSIONS:
        raise ValueError(f"config version {version!r} must be 2.0 or 2.1")
    config = ocio.Config()
    config.setVersion(*map(int, version.split(".")))
    config.setName("cg2raw")
    config.setDescription(
        "Camera RAW as colour spaces: convert a linear render to one of RAW/* and "
        "write a .dng (cg2raw). They have the colour effects of their sensors; all "
        "other effects, such as lens shading and noise, are the RAW writer's."
    )
    config.setFamilySeparator("/")
    config.setStrictParsingEnabled(True)
    config.setDefaultLumaCoefs([0.2126, 0.7152, 0.0722])
    for space in (*scene_spaces(), *picture_spaces(), *display_spaces()):
        add_space(config, space)
    config.addViewTransform(_display_from_scene())
    config.setDefaultViewTransformName("Colorimetric")
    _set_display(config)
    _set_roles(config)
    _set_file_rules(config)
    return config


def left_to_the_writer(profiles: Sequence[_core.SensorProfile]) -> str:
    """Return in words, from a space on, which effects of which sensors the RAW writer
    has to add; nothing if there are none."""
    listed = [
        f"{profile.id} ({', '.join(left)})"
        for profile in profiles
        if (left := color_effects.left_to_the_writer(profile))
    ]
    return f" Those of the profiles: {', '.join(listed)}." if listed else ""


def add_space(config: chain.Config, space: chain.Space) -> None:
    """Add a colour space; ValueError if there is one of that name."""
    # addColorSpace would replace it silently.
    if config.getColorSpace(space.getName()) is not None:
        raise ValueError(f"colour space {space.getName()!r} is asked for twice")
    config.addColorSpace(space)


def _display_from_scene() -> Any:
    view = ocio.ViewTransform(ocio.REFERENCE_SPACE_SCENE)
    view.setName("Colorimetric")
    view.setDescription("No tone mapping: a RAW space looks as the scene was.")
    view.setTransform(
        chain.matrix(_core.xyz_d65_from_srgb()), ocio.VIEWTRANSFORM_DIR_FROM_REFERENCE
    )
    return view


def _set_display(config: chain.Config) -> None:
    config.addDisplayView(
        display=DISPLAY,
        view=DEVELOPED_VIEW,
        viewTransform="Colorimetric",
        displayColorSpaceName=DISPLAY,
    )
    config.addDisplayView(DISPLAY, DATA_VIEW, DATA)
    config.setActiveDisplays(DISPLAY)
    config.setActiveViews(f"{DEVELOPED_VIEW}, {DATA_VIEW}")


def _set_roles(config: chain.Config) -> None:
    for role, space in {
        "scene_linear": names.SCENE_LINEAR,
        "default": names.SCENE_LINEAR,
        "reference": names.SCENE_LINEAR,
        "rendering": names.SCENE_LINEAR,
        "compositing_linear": names.SCENE_LINEAR,
        "compositing_log": "ACEScct",
        "color_timing": "ACEScct",
        "aces_interchange": "ACES2065-1",
        "cie_xyz_d65_interchange": "CIE XYZ-D65 - Display-referred",
        "color_picking": DISPLAY,
        "texture_paint": TEXTURE,
        "matte_paint": TEXTURE,
        "data": DATA,
    }.items():
        config.setRole(role, space)


def _set_file_rules(config: chain.Config) -> None:
    """A file whose path holds a space's name or alias is in that space; pictures of 8
    bits are sRGB, all else is scene linear."""
    rules = ocio.FileRules()
    rules.insertPathSearchRule(0)
    for extension in ("png", "jpg", "jpeg"):
        rules.insertRule(1, extension, TEXTURE, "*", extension)
    rules.setDefaultRuleColorSpace(names.SCENE_LINEAR)
    config.setFileRules(rules)
