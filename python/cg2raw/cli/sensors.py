# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""List the sensors that are installed, those that match a word, or all of one.

WORD is looked for in ids, makes and models; the whole id of a sensor, or a profile,
prints all that is known of it. ISOs are those that were calibrated; in brackets, those
that can be simulated: one stop beyond. Temperatures are those of the measured neutrals,
or of their hull. Of a sensor with no noise, cg2raw calibrate measures it from darks and
flats. Exits with 1 if nothing matches, or a profile does not load.

examples:
  cg2raw sensors
  cg2raw sensors sony
  cg2raw sensors samsung-s20fe --plot lights.png
  cg2raw sensors --json | jq -r '.sensors[].id'
"""

import argparse
import json
import shutil
import sys
from collections.abc import Mapping, Sequence
from typing import Any, TextIO

from cg2raw import _core
from cg2raw.system import has_folder

COLUMNS = 120  # where there is no terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw sensors."""
    parser.add_argument(
        "word", nargs="?", metavar="WORD", help="of an id, make or model; or a .json"
    )
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")
    parser.add_argument(
        "--schema", action="store_true", help="print the JSON Schema of a profile"
    )
    parser.add_argument(
        "--plot",
        metavar="OUT.png",
        help="draw illuminants and spectral sensitivities of one sensor",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the list or one sensor; return 1 if a profile does not load."""
    word = arguments.word
    if arguments.schema:
        print(_core.profile_schema(), end="")
        return 0
    if word is not None and is_one(word):
        return run_one(arguments)
    from cg2raw.profile.sensor_table import matching

    found, errors = load_all()
    if word is not None:
        found, errors = matching(found, word), []
        if not found:
            _core.load_profile(word)  # says which are near, and which there are
    if arguments.plot:
        refuse_plot(arguments, [sensor["id"] for sensor in found])
    print_list(found, errors, arguments.json)
    return 1 if errors else 0


def is_one(word: str) -> bool:
    """Return whether @word is the id of one sensor, or the path of a profile."""
    return (
        word in _core.installed_profiles() or has_folder(word) or word.endswith(".json")
    )


def refuse_plot(arguments: argparse.Namespace, ids: Sequence[str]) -> None:
    """Raise ValueError for a picture of several sensors."""
    which = f", one of {', '.join(ids)}" if arguments.word is not None else ""
    raise ValueError(f"--plot {arguments.plot}: needs the whole ID of a sensor{which}")


def print_list(
    found: Sequence[Mapping[str, Any]], errors: Sequence[Mapping[str, str]], json_: bool
) -> None:
    """Print the table, or JSON; then what did not load."""
    from cg2raw.profile import sensor_table

    if json_:
        print(json.dumps({"sensors": found, "errors": errors}, indent=2))
        return
    if found and sys.stdout.isatty():
        from rich.console import Console

        columns = columns_of(sys.stdout)
        console = Console(width=columns, markup=False, highlight=False, emoji=False)
        console.print(sensor_table.rich_table(found, columns))
    elif found:
        print("\n".join(sensor_table.plain_table(found)))
    elif not errors:
        folders = ":".join(_core.profile_folders()) or "no folder"
        print(f"cg2raw sensors: none in {folders}", file=sys.stderr)
    for error in errors:
        print(f"cg2raw sensors: {error['error']}", file=sys.stderr)


def run_one(arguments: argparse.Namespace) -> int:
    """Print all of one sensor; return 0."""
    from cg2raw.profile.summary import summary

    profile = _core.load_profile(arguments.word)
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
