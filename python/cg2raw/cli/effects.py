# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""List the effects that are simulated and diagnosed, or explain one.

An effect is a departure of a real camera from an ideal one. Profiles list theirs by
these names (field effects), and so do the verdicts of cg2raw diagnose.

examples:
  cg2raw effects
  cg2raw effects lens_shading
  cg2raw effects --json | jq -r '.[].name'
"""

import argparse
import difflib
import json
import shutil
import sys
import textwrap
from collections.abc import Sequence
from typing import Any

from cg2raw import _core

Effect = dict[str, Any]


COLUMNS = 88  # where there is no terminal
HEAD = ("name", "stage", "pattern", "parameters")
GAP = "  "
OPTIONAL = " (may be left out)"
PATTERNS = {
    "none": "none: the same in every pixel and frame but for its place",
    "fixed": "fixed: drawn once for a sensor, the same in all its frames",
    "temporal": "temporal: drawn anew in every frame",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of cg2raw effects."""
    parser.add_argument("effect", nargs="?", metavar="NAME", help="explain this effect")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print the list or one effect; return 0."""
    effects = _core.effects()
    if arguments.effect is not None:
        effect = effect_of(effects, arguments.effect)
        print(json.dumps(effect, indent=2) if arguments.json else details(effect))
    else:
        print(json.dumps(effects, indent=2) if arguments.json else table(effects))
    return 0


def effect_of(effects: Sequence[Effect], name: str) -> Effect:
    """Return the effect of a name; an unknown one is told the closest."""
    names = [effect["name"] for effect in effects]
    if name in names:
        return effects[names.index(name)]
    if (new := _core.current_effect_name(name)) != name:
        raise ValueError(f'effect "{name}" is called "{new}" since version 0.1')
    close = difflib.get_close_matches(name.lower().replace("-", "_"), names, 1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise ValueError(f'unknown effect "{name}": {hint}there are: {", ".join(names)}')


def table(effects: Sequence[Effect]) -> str:
    """Return one line per effect, in the order in which they act."""
    rows = [HEAD, *map(row_of, effects)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD) - 1)]
    room = columns() - sum(widths) - len(GAP) * len(widths)
    indent = " " * (columns() - room)
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        words = textwrap.wrap(row[-1], max(room, 20)) or [""]
        lines.append(GAP.join([*cells, words[0]]).rstrip())
        lines += [f"{indent}{line}" for line in words[1:]]
    return "\n".join(lines)


def row_of(effect: Effect) -> tuple[str, str, str, str]:
    """Return the cells of one effect."""
    names = ", ".join(parameter["name"] for parameter in effect["parameters"])
    return effect["name"], effect["stage"], effect["pattern"], names


def details(effect: Effect) -> str:
    """Return all that is known of one effect."""
    lines = [
        f"{effect['name']}: {effect['meaning']}",
        f"  stage    {effect['stage']}",
        f"  pattern  {PATTERNS[effect['pattern']]}",
        f"  source   {effect['source']}",
        "",
    ]
    rows = [("parameter", "unit", "from", "to", "none at", "meaning")]
    for parameter in effect["parameters"]:
        numbers = (f"{parameter[key]:g}" for key in ("min", "max", "null"))
        meaning = parameter["meaning"] + OPTIONAL * parameter["optional"]
        rows.append((parameter["name"], parameter["unit"], *numbers, meaning))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        lines.append(f"  {GAP.join(cells)}".rstrip())
    return "\n".join(lines)


def columns() -> int:
    """Return how many columns a line may have."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else COLUMNS
