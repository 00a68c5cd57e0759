# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A config of one RAW space whose sensor and illuminant the environment chooses.

Thousands of pairs load as fast as one: each is files in a folder beside the config, of
which OpenColorIO opens those of the pair in use. A file is called by the words that the
variables hold, <sensor>_<illuminant>.ctf; ':' of sample:7 is a letter like others on
Linux and macOS, and is not allowed in names of Windows."""

import PyOpenColorIO as ocio

from cg2raw._core import SensorProfile

from . import chain, color_effects, export, names
from .config import add_space, base_config
from .spaces import (
    TABLE_REMARK,
    Exposure,
    camera_chain,
    camera_transform,
    raw_space,
    seen_by,
)

STEM = f"${{{names.SENSOR_VARIABLE}}}_${{{names.ILLUMINANT_VARIABLE}}}"
TO_SCENE, UNBOUNDED = "_to_scene", "_unbounded"


def context_config(
    profile: SensorProfile,
    illuminant: str,
    folder: str,
    version: str,
    has_table: bool,
) -> chain.Config:
    """Return the config; files are looked for in @folder, relative to the config.

    profile, illuminant : the pair where the environment says nothing.
    has_table : of the files' Exposure."""
    config = base_config(version)
    config.addEnvironmentVar(names.SENSOR_VARIABLE, profile.id)
    config.addEnvironmentVar(names.ILLUMINANT_VARIABLE, illuminant)
    config.setSearchPath(folder)
    chosen = (
        f"Camera RGB of the sensor ${names.SENSOR_VARIABLE} under the illuminant "
        f"${names.ILLUMINANT_VARIABLE} of the environment"
    )
    clipped = "Clipped at white as the sensor clips, highlights kept white."
    bounded = raw_space(
        *names.CONTEXT,
        names.RAW_FAMILY,
        f"{chosen}. {TABLE_REMARK if has_table else clipped}",
        [_file()],
        [_file(TO_SCENE)],
    )
    add_space(config, bounded)
    if has_table:
        return config
    unbounded = raw_space(
        *names.CONTEXT_UNBOUNDED,
        names.RAW_FAMILY,
        f"{chosen}: one matrix, never clipped.",
        [_file(UNBOUNDED)],
    )
    add_space(config, unbounded)
    config.setInactiveColorSpaces(names.CONTEXT_UNBOUNDED[1])
    return config


def _file(suffix: str = "") -> chain.Op:
    return ocio.FileTransform(f"{STEM}{suffix}.ctf")


def chain_files(
    profile: SensorProfile, illuminant: str, exposure: Exposure | None = None
) -> dict[str, str]:
    """Return {file name: text} of one pair: to RAW, to the scene, and, if there is no
    table, unbounded."""
    exposure = exposure or Exposure()
    transform = camera_transform(profile, illuminant, exposure)
    effects = color_effects.matrix(profile, illuminant)
    seen = seen_by(profile, illuminant, exposure)
    stem = f"{profile.id}_{illuminant}"
    chains = {
        "": camera_chain(transform, effects),
        TO_SCENE: chain.scene_from_camera(transform, effects),
    }
    if not exposure.has_table:
        chains[UNBOUNDED] = chain.camera_from_scene_unbounded(transform, effects)
    return {
        f"{stem}{suffix}.ctf": export.chain_text(
            ops, ".ctf", (profile.id, illuminant), seen, to_scene=suffix == TO_SCENE
        )
        for suffix, ops in chains.items()
    }
