# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parsing of words on the command line, and error messages."""

import argparse
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from cg2raw.core_arguments import check_utf8
from cg2raw.short_messages import about

# Of each command that has commands of its own, these, the one that is meant first.
COMMANDS = {"diagnose": ("run", "check", "compare", "synthesize")}


def with_command(words: Sequence[str]) -> list[str]:
    """Return the words of a command line with the command that diagnose leaves out."""
    known = COMMANDS.get(words[0]) if len(words) > 1 else None
    if known is None or words[1] in (*known, "-h", "--help"):
        return list(words)
    return [words[0], known[0], *words[1:]]


def with_ranges(words: Sequence[str]) -> list[str]:
    """Return the words with --frames and a range below 0, such as -2-1, as one word:
    argparse takes a range for an option."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] == "--frames" and re.match("-[0-9]", word):
            word = f"{joined.pop()}={word}"
        joined.append(word)
    return joined


def check_words(words: Sequence[str]) -> None:
    """Raise ValueError for a word that is not UTF-8."""
    for word in words:
        check_utf8(word)


@contextmanager
def needs_extra(extra: str) -> Iterator[None]:
    """Raise ValueError for a package that is missing, with what installs it."""
    try:
        yield
    except ModuleNotFoundError as missing:
        words = f"needs {missing.name}: pip install 'cg2raw[{extra}]'"
        raise ValueError(words) from None


def about_output(arguments: argparse.Namespace, error: BaseException) -> str:
    """Return an exception's message for a command, by short_messages.about."""
    output = getattr(arguments, "output", None) or getattr(arguments, "out", None)
    return about(output, error)
