# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parsing of words on the command line, and error messages."""

import argparse
import re
from collections.abc import Sequence

from cg2raw.core_arguments import check_utf8
from cg2raw.short_messages import about


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


def about_output(arguments: argparse.Namespace, error: BaseException) -> str:
    """Return an exception's message for a command, by short_messages.about."""
    output = getattr(arguments, "output", None) or getattr(arguments, "out", None)
    return about(output, error)
