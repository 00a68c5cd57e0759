# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The colour spaces of one sensor under one illuminant."""

import dataclasses
from collections.abc import Sequence

import PyOpenColorIO as ocio

from cg2raw import _core
from cg2raw.cfa import is_mono

from . import chain, color_effects, names, spectral_chain


@dataclasses.dataclass(frozen=True)
class Exposure:
    """How sensors are exposed: the same for all spaces of a config.

    convention : "dng" (the exact inverse of a DNG renderer), "paper" or "spectral".
    digital_gain : multiplies the white balance before highlights are protected.
    highlights : keep white white; not in convention spectral, where nothing clips."""

    convention: str = "dng"
    digital_gain: float = 1.0
    highlights: bool = True

    @property
    def has_table(self) -> bool:
        """Return whether chains to RAW have a table, which a config cannot hold."""
        return self.convention.lower() == "spectral"


def raw_spaces(
    profile: _core.SensorProfile, illuminant: str, exposure: Exposure
) -> list[chain.Space]:
    """Return the RAW space of a sensor (a core profile) under an illuminant (a word of
    the grammar) and its unbounded twin. Raises ValueError.

    With a table it has no twin, and its chain is the file names.table_file()."""
    if exposure.has_table:
        return [table_space(profile, illuminant, exposure)]
    transform = camera_transform(profile, illuminant, exposure)
    effects = color_effects.matrix(profile, illuminant)
    seen = seen_by(profile, illuminant, exposure)
    bounded = raw_space(
        *names.raw_space(profile.id, illuminant),
        names.family(profile),
        f"RAW of the {seen} Clipped at white as the sensor clips, highlights kept "
        "white. To the scene: white balance, clip, colour matrix, as in a camera.",
        chain.camera_from_scene(transform, effects),
        chain.scene_from_camera(transform, effects),
    )
    unbounded = raw_space(
        *names.unbounded_space(profile.id, illuminant),
        names.family(profile),
        f"One matrix, never clipped, for work on HDR: camera RGB of the {seen}",
        chain.camera_from_scene_unbounded(transform, effects),
    )
    return [bounded, unbounded]


def table_space(
    profile: _core.SensorProfile, illuminant: str, exposure: Exposure
) -> chain.Space:
    """Return the RAW space of a sensor whose chain is a file."""
    transform = camera_transform(profile, illuminant, exposure)
    effects = color_effects.matrix(profile, illuminant)
    return raw_space(
        *names.raw_space(profile.id, illuminant),
        names.family(profile),
        f"RAW of the {seen_by(profile, illuminant, exposure)} {TABLE_REMARK}",
        [ocio.FileTransform(names.table_file(profile.id, illuminant))],
        chain.scene_from_camera(transform, effects),
    )


# Of the spaces of convention spectral.
TABLE_REMARK = (
    "Never clipped: the sensor does that. To the scene: white balance, clip, colour "
    "matrix of the profile, as in a camera, which is no inverse."
)


def all_raw_spaces(
    profiles: Sequence[_core.SensorProfile],
    illuminants: Sequence[str],
    exposure: Exposure | None,
) -> tuple[list[chain.Space], list[str]]:
    """Return (spaces, inactive) of each profile x illuminant: RAW spaces and their
    twins, and the aliases by which a config's inactive list names the twins (names may
    hold colons, at which that list is taken apart).

    exposure : an Exposure; None for the default one."""
    pairs = [
        raw_spaces(profile, illuminant, exposure or Exposure())
        for profile in profiles
        for illuminant in illuminants
    ]
    inactive = [list(twin.getAliases())[0] for _, *twins in pairs for twin in twins]
    return [space for pair in pairs for space in pair], inactive


def camera_transform(
    profile: _core.SensorProfile, illuminant: str, exposure: Exposure
) -> _core.CameraTransform:
    """Return the core's CameraTransform of a sensor under an illuminant (a word).

    Raises ValueError for the convention sensor: its light has no white to clip at; and
    for a monochrome sensor, which has no space of colours."""
    if is_mono(profile.cfa):
        raise ValueError(
            f"sensor {profile.id} is monochrome and has no RAW colour space: leave it "
            "out, and write its DNG from the scene (dng:sensor)"
        )
    if exposure.convention.lower() == "sensor":
        raise ValueError(
            "convention sensor has no RAW space of its own: take the unbounded space "
            "of convention dng"
        )
    return _core.camera_from_scene(
        profile,
        profile.illuminant(illuminant),
        exposure.convention,
        exposure.digital_gain,
        exposure.highlights,
    )


def camera_chain(
    transform: _core.CameraTransform, effects: chain.Array | None
) -> list[chain.Op]:
    """Return linear Rec.709 -> camera RGB as a list of transforms."""
    if transform.uplift is None:
        return chain.camera_from_scene(transform, effects)
    return spectral_chain.camera_from_scene(transform, effects)


def seen_by(profile: _core.SensorProfile, illuminant: str, exposure: Exposure) -> str:
    """Return in words what a RAW space holds: camera, light, exposure."""
    light = profile.illuminant(illuminant)
    red, _, blue = light.neutral
    text = (
        f"{_core.camera_name(profile.make, profile.model)} under {light.spec} "
        f"({light.cct:.0f} K, Duv {light.duv:+.4f}; neutral R/G {red:.4f}, "
        f"B/G {blue:.4f}), convention {exposure.convention}"
    )
    if exposure.has_table:
        spectrum = camera_transform(profile, illuminant, exposure).spectrum
        text += f", by the spectrum of {spectrum}"
    if exposure.digital_gain != 1.0:
        text += f", digital gain {exposure.digital_gain:g}"
    if not exposure.highlights:
        text += ", highlights not protected"
    effects = [setting["name"] for setting in color_effects.settings_of(profile)]
    if effects:
        text += f", with the sensor's {', '.join(effects)}"
    return text + "." + left_out(profile)


def left_out(profile: _core.SensorProfile) -> str:
    """Return a sentence on the effects of a sensor that no RAW space has, with a space
    before it; nothing if it has none."""
    names_left = color_effects.left_to_the_writer(profile)
    if not names_left:
        return ""
    return f" Effects left to the RAW writer: {', '.join(names_left)}."


def raw_space(
    name: str,
    alias: str,
    interop_id: str,
    family: str,
    description: str,
    from_scene: Sequence[chain.Op],
    to_scene: Sequence[chain.Op] | None = None,
) -> chain.Space:
    """Return a colour space of camera RGB; the chains are lists of transforms.

    interop_id : what hosts write into files of the space; may be empty. It has to be an
    alias, too. OpenColorIO before 2.5 skips it; config_text writes it."""
    space = ocio.ColorSpace(
        referenceSpace=ocio.REFERENCE_SPACE_SCENE,
        name=name,
        aliases=[name for name in (alias, interop_id) if name],
        family=family,
        description=description,
        encoding="scene-linear",
        bitDepth=ocio.BIT_DEPTH_F32,
    )
    space.addCategory("file-io")
    if interop_id and hasattr(space, "setInteropID"):
        space.setInteropID(interop_id)
    space.setTransform(group(from_scene), ocio.COLORSPACE_DIR_FROM_REFERENCE)
    if to_scene:
        space.setTransform(group(to_scene), ocio.COLORSPACE_DIR_TO_REFERENCE)
    return space


def group(transforms: Sequence[chain.Op]) -> chain.Op:
    """Return one transform of a list of them."""
    result = ocio.GroupTransform()
    for transform in transforms:
        result.appendTransform(transform)
    return result
