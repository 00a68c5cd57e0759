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
from .spaces import Exposure, camera_transform, raw_space, seen_by

STEM = f"${{{names.SENSOR_VARIABLE}}}_${{{names.ILLUMINANT_VARIABLE}}}"
TO_SCENE, UNBOUNDED = "_to_scene", "_unbounded"


def context_config(
    profile: SensorProfile, illuminant: str, folder: str, version: str = "2.1"
) -> chain.Config:
    """Return the config; files are looked for in @folder, relative to the config.

    profile, illuminant : the pair where the environment says nothing."""
    config = base_config(version)
    config.addEnvironmentVar(names.SENSOR_VARIABLE, profile.id)
    config.addEnvironmentVar(names.ILLUMINANT_VARIABLE, illuminant)
    config.setSearchPath(folder)
    chosen = (
        f"Camera RGB of the sensor ${names.SENSOR_VARIABLE} under the illuminant "
        f"${names.ILLUMINANT_VARIABLE} of the environment"
    )
    bounded = raw_space(
        *names.CONTEXT,
        names.RAW_FAMILY,
        f"{chosen}. Clipped at white as the sensor clips, highlights kept white.",
        [_file()],
        [_file(TO_SCENE)],
    )
    unbounded = raw_space(
        *names.CONTEXT_UNBOUNDED,
        names.RAW_FAMILY,
        f"{chosen}: one matrix, never clipped.",
        [_file(UNBOUNDED)],
    )
    for space in (bounded, unbounded):
        add_space(config, space)
    config.setInactiveColorSpaces(names.CONTEXT_UNBOUNDED[1])
    return config


def _file(suffix: str = "") -> chain.Op:
    return ocio.FileTransform(f"{STEM}{suffix}.ctf")


def chain_files(
    profile: SensorProfile, illuminant: str, exposure: Exposure | None = None
) -> dict[str, str]:
    """Return {file name: text} of one pair: to RAW, to the scene, unbounded."""
    exposure = exposure or Exposure()
    transform = camera_transform(profile, illuminant, exposure)
    effects = color_effects.matrix(profile, illuminant)
    seen = seen_by(profile, illuminant, exposure)
    stem = f"{profile.id}_{illuminant}"
    chains = {
        "": chain.camera_from_scene(transform, effects),
        TO_SCENE: chain.scene_from_camera(transform, effects),
        UNBOUNDED: chain.camera_from_scene_unbounded(transform, effects),
    }
    return {
        f"{stem}{suffix}.ctf": export.chain_text(
            ops, ".ctf", (profile.id, illuminant), seen, to_scene=suffix == TO_SCENE
        )
        for suffix, ops in chains.items()
    }
