# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A file of the DNG plugin, and which OpenImageIO it is built for."""

import platform
import re
from pathlib import Path

from cg2raw.oiio.elf import Library, read_library
from cg2raw.system import PLUGIN_SUFFIX

NAME = f"dng.imageio{PLUGIN_SUFFIX}"
PROPER = "libcg2raw_dng_imageio.so"  # beside NAME in a wheel, where NAME only loads it
# OIIO_PLUGIN_VERSION since OpenImageIO 2.3, 3.0 and 3.1. Source: its oiioversion.h.
PLUGIN_APIS = (((3, 3), None), ((3, 1), 27), ((2, 6), 26), ((2, 3), 25))
API_NAMES = {
    25: "OpenImageIO 2.3 to 2.5",
    26: "OpenImageIO 3.0",
    27: "OpenImageIO 3.1 to 3.2",
}


def folders_in(place: Path) -> list[Path]:
    """Return the folders of @place that may hold a plugin: that of one SDK, then those
    of the wheel, one for each C++ namespace of OpenImageIO, the newest first."""
    portable = sorted(place.glob("lib/cg2raw/oiio-*"), reverse=True)
    return [place / "lib/cg2raw/oiio", *portable]


def version_of(text: str) -> tuple[int, ...]:
    """Return "3.2.2.0" as (3, 2)."""
    return tuple(int(number) for number in re.findall(r"\d+", text)[:2])


def plugin_api_of(version: str) -> int | None:
    """Return the plugin API that an OpenImageIO accepts, None if it is not known."""
    known = [api for first, api in PLUGIN_APIS if version_of(version) >= first]
    return known[0] if known else None


def read_plugin(path: str) -> Library:
    """Return what the plugin file at @path is, with its plugin API as value.

    Raises ValueError, OSError as read_library."""
    return read_library(path, "dng_imageio_version")


def misfit(library: Library, version: str, path: str) -> str:
    """Return why @library at @path cannot be a plugin of OpenImageIO @version; empty if
    it may.

    What is not known of a version is left to OpenImageIO."""
    if library.machine != platform.machine():
        return f"is for {library.machine}, this machine is {platform.machine()}"
    if library.value is None:
        return "is no OpenImageIO plugin for dng (no dng_imageio_version in it)"
    wanted = plugin_api_of(version)
    if wanted is not None and library.value != wanted:
        name = API_NAMES.get(library.value, "another OpenImageIO")
        return (
            f"is built for plugin API {library.value} ({name}); OpenImageIO "
            f"{version} wants {wanted}"
        )
    # Before 3 each minor version has a C++ namespace of its own, but not a plugin API.
    found = re.fullmatch(r"oiio-([23]\.\d+)", Path(path).parent.name)
    if (
        found
        and version_of(version) < (3, 0)
        and version_of(version) != version_of(found[1])
    ):
        return f"is built for OpenImageIO {found[1]}, not {version}"
    return ""
