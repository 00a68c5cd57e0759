# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""List the sensors that are installed, or all that is known of one.

ISOs are those that were calibrated; in brackets, those that can be simulated: one stop
beyond. Temperatures are those of the measured neutrals, or of their hull. Exits with 1
if a profile does not load.

examples:
  cg2raw sensors
  cg2raw sensors samsung-s20fe --plot lights.png
  cg2raw sensors ./my-camera.json
  cg2raw sensors --json | jq -r '.sensors[].id'
"""

import argparse
import json
import shutil
import sys
from typing import Any, TextIO

from cg2raw import _core
from cg2raw.cli._pairs import load_one

COLUMNS = 120  # where there is no terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw sensors."""
    parser.add_argument("id", nargs="?", metavar="ID", help="one sensor, or a .json")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")
    parser.add_argument(
        "--plot",
        metavar="OUT.png",
        help="draw illuminants and spectral sensitivities of ID",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the list or one sensor; return 1 if a profile does not load."""
    if arguments.id is not None:
        return run_one(arguments)
    if arguments.plot:
        raise ValueError(f"--plot {arguments.plot}: needs the ID of a sensor")
    from cg2raw.profile import sensor_text

    found, errors = load_all()
    if arguments.json:
        print(json.dumps({"sensors": found, "errors": errors}, indent=2))
    elif found:
        columns = columns_of(sys.stdout) if sys.stdout.isatty() else None
        print("\n".join(sensor_text.table(found, columns)))
    if not found and not errors:
        folders = ":".join(_core.profile_folders()) or "no folder"
        print(f"cg2raw sensors: none in {folders}", file=sys.stderr)
    if not arguments.json:
        for error in errors:
            print(f"cg2raw sensors: {error['error']}", file=sys.stderr)
    return 1 if errors else 0


def run_one(arguments: argparse.Namespace) -> int:
    """Print all of one sensor; return 0."""
    from cg2raw.profile.summary import summary

    profile = load_one(arguments.id)
    found = summary(profile)
    if arguments.plot:
        plot(profile, found, arguments.plot)
    if arguments.json:
        print(json.dumps(found, indent=2))
    else:
        print("\n".join(details(found)))
    return 0


def details(found: dict[str, Any]) -> list[str]:
    """Return the lines on one sensor, as wide as the terminal."""
    from cg2raw.profile import sensor_text

    encoding = sys.stdout.encoding or "ascii"
    return sensor_text.details(found, columns_of(sys.stdout), encoding)


def plot(profile: _core.SensorProfile, found: dict[str, Any], path: str) -> None:
    """Write the picture of the sensor's illuminants and sensitivities."""
    from cg2raw.io.atomic_file import write_atomically
    from cg2raw.profile.plot import plot_png

    if not path.lower().endswith(".png"):
        raise ValueError(f"--plot {path}: must end in .png")
    write_atomically(path, plot_png(profile, found["illuminants"]["cct"]))


def load_all() -> tuple[list[dict[str, Any]], list[dict[str, str]]]:
    """Return (summaries, [{"id", "error"}]) of all installed profiles."""
    from cg2raw.profile.summary import summary

    found, errors = [], []
    for id in _core.installed_profiles():
        try:
            found.append(summary(_core.load_profile(id)))
        except ValueError as error:
            errors.append({"id": id, "error": str(error)})
    return found, errors


def columns_of(stream: TextIO) -> int:
    """Return how many columns a line may have."""
    return shutil.get_terminal_size().columns if stream.isatty() else COLUMNS
