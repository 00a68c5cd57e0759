# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Print the shell lines by which OpenImageIO finds the plugin, and OCIO the config.

Looks in the source tree or the prefix that this command is part of, or in --prefix.
Plugin folders come before those that the variables name already. An OCIO config that
$OCIO names stays, and stderr says so.

examples:
  eval "$(cg2raw env)"                            # bash, zsh, sh
  cg2raw env --shell fish | source
  eval "$(cg2raw env --prefix ~/cg2raw)"
  cg2raw env --json
"""

import argparse
import json
import os
import platform
import shlex
import sys
from pathlib import Path

from cg2raw.oiio import plugin_file

CONFIG = "share/cg2raw/ocio/sensors.ocio"
# OpenImageIO 2 reads OIIO_LIBRARY_PATH only; 3 that one first, then its own.
API_OF_3 = 26


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw env."""
    add = parser.add_argument
    add("--shell", choices=("sh", "bash", "zsh", "fish"), default="sh")
    add("--prefix", metavar="FOLDER", help="where cmake --install put the plugin")
    add("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print the lines; return 1 if there is no plugin."""
    places = search_places(arguments.prefix)
    plugins = plugins_in(places)
    config = next((str(p / CONFIG) for p in places if (p / CONFIG).is_file()), None)
    variables = variables_of(plugins, config)
    if arguments.json:
        print(json.dumps(variables, indent=2))
    else:
        for name, value in variables.items():
            print(line_of(name, value, arguments.shell))
    if plugins:
        return 0
    where = arguments.prefix or "this installation"
    print(
        f"cg2raw env: no plugin for OpenImageIO in {where}: build it (scripts/setup), "
        "or name its --prefix",
        file=sys.stderr,
    )
    return 1


def search_places(prefix: str | None) -> list[Path]:
    """Return the folders that may hold lib/ and share/, the nearest first."""
    if prefix is not None:
        if not os.path.isdir(prefix):
            raise ValueError(f"--prefix {prefix}: is no folder")
        return [Path(os.path.abspath(prefix))]
    here = Path(os.path.abspath(__file__))
    near = dict.fromkeys([*here.parents, *here.resolve().parents])
    builds = [
        build
        for parent in near
        for name in ("system", "wheel", "*")
        for build in sorted(parent.glob(f"build/{name}"))
    ]
    return list(dict.fromkeys([*near, *builds]))


def plugins_in(places: list[Path]) -> dict[int, str]:
    """Return {plugin API: folder}, the highest first and the nearest of each.

    OpenImageIO 2 refuses the plugin of 3 at once; 3 would load all of 2 to refuse its.
    """
    found: dict[int, str] = {}
    folders = [folder for place in places for folder in plugin_file.folders_in(place)]
    for path in [folder / plugin_file.NAME for folder in folders]:
        if not path.is_file():
            continue
        try:
            library = plugin_file.read_plugin(str(path))
        except (ValueError, OSError) as error:
            print(f"cg2raw env: {path} {error}; left out", file=sys.stderr)
            continue
        if library.machine == platform.machine() and library.value is not None:
            found.setdefault(library.value, str(path.parent))
    return dict(sorted(found.items(), reverse=True))


def variables_of(plugins: dict[int, str], config: str | None) -> dict[str, str]:
    """Return {variable: value}; OCIO only where it names no other config."""
    variables = {}
    for name, folders in (
        ("OIIO_LIBRARY_PATH", list(plugins.values())),
        (
            "OPENIMAGEIO_PLUGIN_PATH",
            [folder for api, folder in plugins.items() if api >= API_OF_3],
        ),
    ):
        kept = [folder for folder in os.environ.get(name, "").split(":") if folder]
        if folders:
            variables[name] = ":".join(dict.fromkeys([*folders, *kept]))
    theirs = os.environ.get("OCIO")
    if config and theirs in (None, "", config):
        variables["OCIO"] = config
    elif config:
        print(
            f"cg2raw env: OCIO stays {theirs}; the sensors' config is {config}",
            file=sys.stderr,
        )
    return variables


def line_of(name: str, value: str, shell: str) -> str:
    """Return the line that sets a variable in @shell."""
    if shell == "fish":
        quoted = value.replace("\\", "\\\\").replace("'", "\\'")
        return f"set -gx {name} '{quoted}'"
    return f"export {name}={shlex.quote(value)}"
