# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The DNG plugin, made known to the OpenImageIO of this Python.

OpenImageIO looks for plugins when it first meets an unknown format, in the folders of
its attribute plugin_searchpath. It is not imported for that: if it is not there yet, it
is told once it is. Environment variables stay as they are, since child processes may
run another OpenImageIO."""

import importlib.abc
import importlib.machinery
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from cg2raw.oiio import plugin_file

MODULE = "OpenImageIO"


def register() -> None:
    """Tell OpenImageIO where its plugin lies: now, or once it is imported."""
    loaded = sys.modules.get(MODULE)
    if loaded is not None:
        tell(loaded)
    elif not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


def tell(openimageio: ModuleType) -> None:
    """Put the folder of the plugin that fits first on OpenImageIO's search path.

    Says nothing if there is none, or if OpenImageIO is not what it should be: `cg2raw
    doctor` tells."""
    try:
        plugin = plugin_for(openimageio.VERSION_STRING)
        known = openimageio.get_string_attribute("plugin_searchpath")
        folder = os.path.dirname(plugin)
        if plugin and folder not in known.split(os.pathsep):
            path = folder + os.pathsep + known if known else folder
            openimageio.attribute("plugin_searchpath", path)
    except (AttributeError, OSError, TypeError, ValueError):
        return


def plugin_for(version: str) -> str:
    """Return the plugin file for an OpenImageIO of that version; empty if none is here.

    Another OpenImageIO's is left out: to refuse it, OpenImageIO would load that library
    too."""
    if plugin_file.plugin_api_of(version) is None:
        return ""
    for folder in plugin_folders():
        path = os.path.join(folder, plugin_file.NAME)
        try:
            if not plugin_file.misfit(plugin_file.read_plugin(path), version):
                return path
        except (OSError, ValueError):
            continue
    return ""


def plugin_folders() -> list[str]:
    """Return where the plugin of this very package may lie.

    Plugins are programs, so no more than: the builds of the source tree that it is part
    of, the lib folder that it is installed in, and that of this Python's prefix."""
    here, source = Path(os.path.abspath(__file__)), Path(__file__).resolve()
    folders = [here.parents[3], here.parents[4], Path(sys.prefix, "lib")]
    folders = [lib / "cg2raw/oiio" for lib in folders if lib.name == "lib"]
    root = source.parents[3]
    if (root / "plugins/dng.imageio").is_dir():
        folders = [*sorted(root.glob("build/*/lib/cg2raw/oiio")), *folders]
    return [str(folder) for folder in dict.fromkeys(folders)]


class _Finder(importlib.abc.MetaPathFinder):
    """Finds nothing itself; sees to it that OpenImageIO is told after its import."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname != MODULE:
            return None
        spec = None
        for finder in sys.meta_path:
            if finder is not self and (
                spec := finder.find_spec(fullname, path, target)
            ):
                break
        if spec is None or spec.loader is None:
            return None
        spec.loader = _Loader(spec.loader)
        return spec


class _Loader(importlib.abc.Loader):
    """The module's own loader, and then tell()."""

    def __init__(self, loader: importlib.abc.Loader) -> None:
        self._loader = loader

    def __getattr__(self, name: str) -> object:
        return getattr(self._loader, name)

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        self._loader.exec_module(module)
        tell(module)
