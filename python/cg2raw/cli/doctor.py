# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which OpenImageIO finds the DNG plugin, which does not, and why.

Looks at every oiiotool and every Python with OpenImageIO on PATH, lists the plugins
that each finds, and lets each write a 16x16 DNG and read one. OpenImageIO itself skips
a plugin that does not fit without a word, and without LibRaw takes a DNG's 8-bit
preview for its picture. Exits with 1 if none of them can write a DNG.

examples:
  cg2raw doctor
  PATH=/opt/studio/bin:$PATH cg2raw doctor     # of another oiiotool
  cg2raw doctor --json | jq .works
"""

import argparse
import json
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.dng import write_dng
from cg2raw.interrupts import scratch_folder
from cg2raw.oiio import hosts, plugin_file, registration
from cg2raw.sensor import Sensor

Report = dict[str, Any]  # of JSON's types

# What a host makes of a DNG, by the format that reads it.
READS = {
    "dng": "a DNG's mosaic, by this plugin",
    "raw": "a DNG by LibRaw, which develops it; this plugin's reader is cg2raw there",
    "tiff": "only the 8-bit preview of a DNG, without a word: no LibRaw is built in; "
    "this plugin reads the mosaic",
    "": "no DNG",
}


@dataclass
class Plugin:
    """One plugin file as one host sees it."""

    path: str
    plugin_api: int | None
    reason: str  # why the host does not use it; empty if it does

    @property
    def loads(self) -> bool:
        """Return whether the host uses this file."""
        return not self.reason


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw doctor."""
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print the report; return 0 if at least one OpenImageIO writes DNGs, else 1."""
    report = examine()
    print(json.dumps(report, indent=2) if arguments.json else as_text(report))
    return 0 if report["works"] else 1


def examine() -> Report:
    """Return the whole report as JSON's types."""
    folders, sensors = _core.profile_folders(), _core.installed_profiles()
    with scratch_folder("cg2raw-doctor-") as folder:
        shot = written_dng(folder, sensors)
        found = [examine_host(host, sensors, shot) for host in hosts.find_hosts()]
    return {
        "works": any(host["works"] for host in found),
        "hosts": found,
        "sensors": {"folders": folders, "ids": sensors},
    }


def written_dng(folder: str, sensors: list[str]) -> str:
    """Return the path of a DNG with a preview in @folder; empty without sensors."""
    if not sensors:
        return ""
    path = os.path.join(folder, "shot.dng")
    grey = np.full((32, 32, 3), 0.2, np.float32)
    write_dng(path, Sensor(sensors[0]).simulate(grey, illuminant="D65"))
    return path


def examine_host(host: hosts.Host, sensors: list[str], shot: str) -> Report:
    """Return the report on one Host; @shot is a DNG for it to read, or empty."""
    trial = hosts.try_to_write(host, sensors[0] if sensors else "none")
    plugins = plugins_of(host, trial)
    return {
        "kind": host.kind,
        "path": host.path,
        "version": host.version,
        "plugin_api": host.plugin_api,
        "search": [
            {"variable": variable, "folder": folder, "exists": os.path.isdir(folder)}
            for variable, folder in host.search
        ],
        "plugins": [{**vars(plugin), "loads": plugin.loads} for plugin in plugins],
        "works": trial.wrote,
        "reader": hosts.reader_of(host, shot) if shot else None,
        "register_oiio_plugin": plugin_to_register(host),
        "message": "" if trial.wrote else trial.message,
        "remedy": "" if trial.wrote else remedy(host, plugins),
    }


def plugin_to_register(host: hosts.Host) -> str | None:
    """Return the plugin that cg2raw.register_oiio_plugin() finds for the OpenImageIO of
    this Python, empty if none is here; None for other hosts."""
    beside = os.path.realpath(os.path.dirname(sys.executable))
    if host.kind != "python" or os.path.dirname(host.path) != beside:
        return None
    return registration.plugin_for(host.version)


def plugins_of(host: hosts.Host, trial: hosts.Trial) -> list[Plugin]:
    """Return the Plugins in the folders that @host searches, in that order."""
    plugins, in_use = [], ""
    for path in dict.fromkeys(
        os.path.join(folder, plugin_file.NAME) for _, folder in host.search
    ):
        if not os.path.exists(path):
            continue
        api, reason = None, ""
        try:
            library = plugin_file.read_plugin(path)
            api, reason = library.value, plugin_file.misfit(library, host.version, path)
        except (ValueError, OSError) as error:
            reason = str(error)
        reason = reason or (
            f"comes after {in_use}" if in_use else loader_reason(path, trial.loader)
        )
        in_use = in_use or ("" if reason else path)
        plugins.append(Plugin(path, api, reason))
    return plugins


def loader_reason(path: str, log: str) -> str:
    """Return what the dynamic loader had against @path, by its LD_DEBUG=files @log."""
    proper = os.path.join(os.path.dirname(path), plugin_file.PROPER)
    path = proper if os.path.exists(proper) else path
    begin = re.search(rf"file={re.escape(path)} \[\d+\];\s+dynamically loaded by", log)
    if not log or re.search(rf"calling init: {re.escape(path)}$", log, re.MULTILINE):
        return ""
    if not begin:
        return "was not opened, although it lies on the search path"
    after = log[begin.end() :].partition("dynamically loaded by")[0]
    error = re.search(r"error: (.*?) \(fatal\)", after)
    if error:
        return f"does not load: {error[1]}"
    for name, needed_by in re.findall(r"file=(\S+) \[\d+\];\s+needed by (\S+)", after):
        mapped = rf"file={re.escape(name)} \[\d+\];\s+generating link map"
        if not re.search(mapped, after):
            return f"does not load: {name} is not found, needed by {needed_by}"
    return "does not load: the dynamic loader refuses it"


def remedy(host: hosts.Host, plugins: list[Plugin]) -> str:
    """Return one line that helps @host to its plugin."""
    if any(plugin.loads for plugin in plugins):
        return "the plugin is loaded; its message says what it lacks"
    for path in known_plugins():
        try:
            library = plugin_file.read_plugin(path)
            fits = not plugin_file.misfit(library, host.version, path)
        except (ValueError, OSError):
            continue
        if fits and path not in [plugin.path for plugin in plugins]:
            folder = os.path.dirname(path)
            return f'export {host.variable}={folder} (or: eval "$(cg2raw env)")'
    return (
        f"build the plugin for OpenImageIO {host.version}: cmake -S . -B build/own "
        "-DCMAKE_PREFIX_PATH=<its SDK> && cmake --build build/own, then "
        f"export {host.variable}=$PWD/build/own/lib/cg2raw/oiio"
    )


def known_plugins() -> list[str]:
    """Return plugin files of the tree or installation that this module is part of."""
    here = Path(os.path.abspath(__file__))
    parents = dict.fromkeys([*here.parents, *here.resolve().parents])
    places = [
        place
        for parent in parents
        for place in (parent, *sorted(parent.glob("build/*")))
    ]
    found = [
        folder / plugin_file.NAME
        for place in places
        for folder in plugin_file.folders_in(place)
        if (folder / plugin_file.NAME).exists()
    ]
    return [str(path) for path in dict.fromkeys(found)]


def as_text(report: Report) -> str:
    """Return the report for people."""
    lines = []
    for host in report["hosts"]:
        lines += host_lines(host)
    if not report["hosts"]:
        lines.append(
            "no oiiotool, no Python with OpenImageIO on PATH: run scripts/setup"
        )
    sensors = report["sensors"]
    names = ", ".join(sensors["ids"]) or "none"
    lines.append(f"sensors: {len(sensors['ids'])} ({names})")
    lines += [f"  in {folder}" for folder in sensors["folders"]]
    return "\n".join(lines)


def host_lines(host: Report) -> list[str]:
    """Return the lines on one host."""
    api = host["plugin_api"] or "unknown"
    lines = [f"{host['path']}: OpenImageIO {host['version']}, plugin API {api}"]
    for place in host["search"]:
        missing = "" if place["exists"] else "   (no such folder)"
        lines.append(f"  searches  {place['variable']}: {place['folder']}{missing}")
    if not host["search"]:
        lines.append(
            "  searches  nothing: neither OIIO_LIBRARY_PATH nor "
            "OPENIMAGEIO_PLUGIN_PATH names a folder"
        )
    for plugin in host["plugins"]:
        lines.append(f"  plugin    {plugin['path']} {plugin['reason'] or 'loads'}")
    if host["search"] and not host["plugins"]:
        lines.append(f"  plugin    no {plugin_file.NAME} in these folders")
    if host["register_oiio_plugin"] is not None:
        found = host["register_oiio_plugin"] or f"no plugin for API {api}"
        lines.append(f"  cg2raw.register_oiio_plugin() finds {found}")
    lines.append(
        "  writes    "
        + ("a 16x16 DNG: works" if host["works"] else f"no DNG: {host['message']}")
    )
    if host["reader"] is not None:
        lines.append(f"  reads     {READS.get(host['reader'], host['reader'])}")
    if host["remedy"]:
        lines.append(f"  remedy    {host['remedy']}")
    return [*lines, ""]
