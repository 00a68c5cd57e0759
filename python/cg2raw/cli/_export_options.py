# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The core's options of an export as flags of a command line."""

import argparse
import re
from collections.abc import Iterable

from cg2raw import _core

METAVARS = {"text": "TEXT", "word": "WORD", "number": "X", "integer": "N"}
ROWS = {name: rest for name, *rest in _core.export_options()}


def add_options(group: argparse._ArgumentGroup, *names: str) -> None:
    """Declare options by the core's names. Their values stay texts: the core checks
    them."""
    for name in names:
        _, kind, allowed, description = ROWS[name]
        flags = ["--" + name.replace("_", "-")]
        if name == "sensor":
            flags = ["-s", *flags]  # as in all other commands
        text = plain_text(description)
        if kind != "flag" and not allowed.startswith("a whole number"):
            text = f"{allowed}: {text}"
        text = text.replace("%", "%%")
        if kind == "flag":
            group.add_argument(*flags, action=argparse.BooleanOptionalAction, help=text)
        else:
            group.add_argument(*flags, metavar=METAVARS[kind], help=text)


def add_bracket(group: argparse._ArgumentGroup) -> None:
    """Declare --bracket: an option of the core for each of several files."""
    group.add_argument(
        "--bracket",
        metavar="STOPS",
        help="a file for each of these exposures, such as --bracket=-2,0,2, whose "
        "exposure time is so many stops longer",
    )


def add_colorspace(group: argparse._ArgumentGroup) -> None:
    """Declare --iscolorspace."""
    group.add_argument(
        "--iscolorspace", metavar="NAME", help="of the pixels, whatever the file says"
    )


def given_options(
    arguments: argparse.Namespace, names: Iterable[str]
) -> dict[str, str]:
    """Return {name: text} of those options of the core that were given."""
    found = {}
    for name in names:
        value = getattr(arguments, name)
        if value is not None:
            found[name] = str(int(value)) if isinstance(value, bool) else str(value)
    return found


def checked_options(
    arguments: argparse.Namespace, names: Iterable[str]
) -> dict[str, str]:
    """Return given_options. Raises ValueError for values that the core refuses."""
    from cg2raw.conversion import DIALECT

    found = given_options(arguments, names)
    _core.ExportOptions(found, DIALECT)
    return found


def plain_text(description: str) -> str:
    """Return Markdown without its links to other pages, and without backticks."""
    text = re.sub(r": \[[^]]*\]\([^)]*\)| \(\[[^]]*\]\([^)]*\)\)", "", description)
    return text.replace("`", "")
