# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shell completion of the command line, written by shtab."""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cg2raw import _core
from cg2raw.near_words import CIE_LAMPS, DAYLIGHTS

SHELLS = ("bash", "zsh", "tcsh")
MISSING = "needs shtab: pip install 'cg2raw[completion]'"
# What an argument that is called so holds.
FILES = ("IN", "OUT", "FILE", "FOLDER", "REPORT", "PATH", "CONFIG", "PROFILE")
SENSORS = ("sensor", "sensors", "upi_sensors", "word")
LIGHTS = ("illuminant", "illuminants")
EFFECTS = ("effect", "exclude", "include", "effects")


class PrintCompletion(argparse.Action):
    """Print the completion of the whole command line for a shell, and exit."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        try:
            import shtab
        except ImportError:
            print(f"cg2raw {option_string}: {MISSING}", file=sys.stderr)
            parser.exit(1)
        for action in actions_of(parser):
            say_what_completes(action, shtab.FILE)
        print(shtab.complete(parser, shell=str(values)))
        parser.exit()


def actions_of(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of a parser's subcommands, and of theirs."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from command._actions
                yield from actions_of(command)


def say_what_completes(action: argparse.Action, files: Mapping[str, Any]) -> None:
    """Note at an argument what stands for it: known words, or files."""
    words = words_of(action.dest)
    if words and action.choices is None:
        action.choices = words
    elif isinstance(action.metavar, str) and is_file(action.metavar):
        action.complete = files  # type: ignore[attr-defined]


def words_of(name: str) -> list[str]:
    """Return the words of an argument of that name, none if any will do."""
    if name in SENSORS:
        return [*_core.installed_profiles(), *["all"] * name.endswith("sensors")]
    if name in LIGHTS:
        return ["A", *DAYLIGHTS, "3200K", "sample:0", *CIE_LAMPS]
    return [effect["name"] for effect in _core.effects()] if name in EFFECTS else []


def is_file(metavar: str) -> bool:
    """Return whether an argument is the path of a file or folder."""
    return metavar.partition(".")[0] in FILES or "." in metavar
