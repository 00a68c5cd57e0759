# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The DNG plugin, made known to the OpenImageIO of this Python.

OpenImageIO looks for plugins when it first meets an unknown format, in the folders of
its attribute plugin_searchpath. Environment variables stay as they are, since child
processes may run another OpenImageIO."""

import os
import sys
from pathlib import Path

from cg2raw.oiio import plugin_file
from cg2raw.oiio.openimageio import openimageio


def register_oiio_plugin() -> str:
    """Let the OpenImageIO of this Python write DNGs; return the path of the plugin.

    Puts the folder of the plugin that was built with this package for this very
    OpenImageIO first on the search path of OpenImageIO. Call it once, before the first
    DNG is written; a second call changes nothing. What cg2raw itself does, write_dng
    too, needs no plugin.

    Raises ValueError if OpenImageIO is not installed, and if there is no plugin for it;
    `cg2raw doctor` says what is there."""
    module = openimageio()
    version = module.VERSION_STRING
    plugin = plugin_for(version)
    if not plugin:
        raise ValueError(missing(version))
    folder = os.path.dirname(plugin)
    known = module.get_string_attribute("plugin_searchpath")
    if folder not in known.split(os.pathsep):
        path = folder + os.pathsep + known if known else folder
        module.attribute("plugin_searchpath", path)
    return plugin


def missing(version: str) -> str:
    """Return one line on an OpenImageIO that has no plugin here, and what helps."""
    wanted = plugin_file.plugin_api_of(version) or "unknown to this cg2raw"
    apis = []
    for folder in plugin_folders():
        try:
            found = plugin_file.read_plugin(os.path.join(folder, plugin_file.NAME))
        except (OSError, ValueError):
            continue
        apis.append(found.value)
    known = [plugin_file.API_NAMES[api] for api in plugin_file.API_NAMES if api in apis]
    return (
        f"there is no DNG plugin for OpenImageIO {version} in this installation of "
        f"cg2raw: its plugin API is {wanted}, and there are plugins for "
        f"{', '.join(known) or 'none'}; install a wheel of cg2raw and one of these, or "
        "build the plugin (scripts/setup)"
    )


def plugin_for(version: str) -> str:
    """Return the plugin file for an OpenImageIO of that version; empty if none is here.

    Another OpenImageIO's is left out: to refuse it, OpenImageIO would load that library
    too."""
    if plugin_file.plugin_api_of(version) is None:
        return ""
    for folder in plugin_folders():
        path = os.path.join(folder, plugin_file.NAME)
        try:
            if not plugin_file.misfit(plugin_file.read_plugin(path), version, path):
                return path
        except (OSError, ValueError):
            continue
    return ""


def plugin_folders() -> list[str]:
    """Return where the plugin of this very package may lie.

    Plugins are programs, so no more than: the builds of the source tree that it is part
    of, the package itself if it is a wheel's, the lib folder that it is installed in,
    and that of this Python's prefix."""
    here, source = Path(os.path.abspath(__file__)), Path(__file__).resolve()
    libs = [here.parents[3], here.parents[4], Path(sys.prefix, "lib")]
    places = [lib.parent for lib in libs if lib.name == "lib"]
    folders = [*plugin_file.folders_in(here.parents[1])[1:]]
    folders += [folder for place in places for folder in plugin_file.folders_in(place)]
    root = source.parents[3]
    if (root / "plugins/dng.imageio").is_dir():
        folders = [*sorted(root.glob("build/*/lib/cg2raw/oiio")), *folders]
    return [str(folder) for folder in dict.fromkeys(folders)]
