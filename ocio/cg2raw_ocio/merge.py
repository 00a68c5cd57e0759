# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""RAW spaces put into a studio's config, through OpenColorIO's own merging.

A studio's scene reference is another one than ours, as a rule ACES2065-1. Merging finds
the way between the two by the role aces_interchange, and puts it before each chain."""

import contextlib
import os
from collections.abc import Iterator, Sequence
from typing import Any

import PyOpenColorIO as ocio

from cg2raw._core import SensorProfile

from .chain import Config, Space
from .fixed_spaces import interchange_space
from .spaces import Exposure, all_raw_spaces

BUILT_IN = "ocio://"
# What stands for "the newest" is pinned: what it means changes with OpenColorIO, and a
# config of profile 2.6 does not load in applications of the year 2026 (OCIO 2.5).
PINNED = {
    "default": "cg-config-v2.2.0_aces-v1.3_ocio-v2.4",
    "cg-config-latest": "cg-config-v2.2.0_aces-v1.3_ocio-v2.4",
    "studio-config-latest": "studio-config-v2.2.0_aces-v1.3_ocio-v2.4",
}


def check_can_merge() -> None:
    """Raise ValueError if this OpenColorIO cannot merge configs."""
    if not hasattr(ocio, "ConfigMergingHelpers"):
        raise ValueError(
            f"--merge needs PyOpenColorIO 2.5 or newer, this is {ocio.__version__}; "
            "pip install 'opencolorio>=2.5' (the result loads in older versions too)"
        )


def studio_config(source: str) -> Config:
    """Return the config of a path or of ocio://<name of a built-in config>.

    Raises ValueError for one that cannot be read or cannot be merged with."""
    if source.startswith(BUILT_IN):
        config = _built_in(source[len(BUILT_IN) :])
    elif not os.path.isfile(source):
        raise ValueError(f"--merge {source}: no such file")
    elif source.lower().endswith(".ocioz"):
        raise ValueError(
            f"--merge {source}: an archive; take it apart first: ocioarchive --extract"
        )
    else:
        config = _read(source)
    if config.getMajorVersion() < 2:
        raise ValueError(
            f"--merge {source}: ocio_profile_version is {config.getMajorVersion()}; "
            "must be 2.0 or newer: RAW spaces need operators of OpenColorIO 2"
        )
    if not config.hasRole(ocio.ROLE_INTERCHANGE_SCENE):
        raise ValueError(
            f"--merge {source}: has no role {ocio.ROLE_INTERCHANGE_SCENE}; add it to "
            "roles, naming the config's ACES2065-1, so that the two scene references "
            "are known to each other"
        )
    return config


def _built_in(name: str) -> Config:
    name = PINNED.get(name, name)
    registry = ocio.BuiltinConfigRegistry()
    known = [entry[0] for entry in registry.getBuiltinConfigs()]
    if name not in known:
        raise ValueError(
            f"--merge {BUILT_IN}{name}: OpenColorIO {ocio.__version__} has no such "
            f"config; it has {', '.join([*PINNED, *known])}"
        )
    return ocio.Config.CreateFromBuiltinConfig(name)


def _read(path: str) -> Config:
    try:
        return ocio.Config.CreateFromFile(path)
    except ocio.Exception as error:
        raise ValueError(f"--merge {path}: {error}") from None


def merged_config(
    studio: Config,
    profiles: Sequence[SensorProfile],
    illuminants: Sequence[str],
    exposure: Exposure | None,
    folder: str | None,
) -> Config:
    """Return @studio with a RAW space, and its unbounded twin, for each profile x
    illuminant; all else is the studio's. Raises ValueError for a name it has already.

    folder : where table_files() lie, relative to the config, if the exposure has_table.
    """
    check_can_merge()
    name = studio.getRoleColorSpace(ocio.ROLE_INTERCHANGE_SCENE)
    ours = ocio.Config()
    ours.setVersion(2, 0)
    ours.setFamilySeparator("/")
    # By the studio's name, so that merging takes the studio's and drops this one.
    ours.addColorSpace(interchange_space(name))
    ours.setRole(ocio.ROLE_INTERCHANGE_SCENE, name)
    spaces, inactive = all_raw_spaces(profiles, illuminants, exposure)
    for space in spaces:
        _check_free(studio, space)
        ours.addColorSpace(space)
    with _quiet():
        merged = ocio.ConfigMergingHelpers.MergeConfigs(_spaces_only(), studio, ours)
        listed = [studio.getInactiveColorSpaces(), *inactive]
        merged.setInactiveColorSpaces(", ".join(filter(None, listed)))
        if folder is not None:
            _look_for_files_in(merged, folder)
        merged.validate()
    return merged


def _look_for_files_in(config: Config, folder: str) -> None:
    """Add a folder to where a config looks for files. One that names no folders looks
    beside itself, and goes on doing so."""
    if not list(config.getSearchPaths()):
        config.addSearchPath(".")
    config.addSearchPath(folder)


def _spaces_only() -> Any:
    """Return parameters of a merge that adds colour spaces and changes nothing."""
    kind = ocio.ConfigMergingParameters
    parameters = kind.Create()
    parameters.setDefaultStrategy(kind.STRATEGY_BASE_ONLY)
    parameters.setColorspaces(kind.STRATEGY_PREFER_BASE)
    parameters.setAdjustInputReferenceSpace(True)
    parameters.setAvoidDuplicates(False)
    parameters.setInputFirst(False)
    return parameters


def _check_free(studio: Config, space: Space) -> None:
    for name in (space.getName(), *space.getAliases()):
        if studio.getColorSpace(name) or studio.getNamedTransform(name):
            raise ValueError(
                f"the config to merge with has {name!r} already; leave that sensor or "
                "illuminant out, or merge with the config without RAW spaces"
            )


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Merging warns of each space that it leaves as it is, which is what we want, and
    validation of what was amiss in the studio's config before."""
    level = ocio.GetLoggingLevel()
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)
    try:
        yield
    finally:
        ocio.SetLoggingLevel(level)


def relative_folders(studio: Config) -> list[str]:
    """Return the folders of LUTs that the config looks for beside itself."""
    paths = list(studio.getSearchPaths())
    return [p for p in paths if p and not os.path.isabs(p) and not p.startswith("$")]
