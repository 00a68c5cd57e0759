# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parsing of words on the command line, and error messages."""

import argparse
from collections.abc import Sequence

from cg2raw.core_arguments import has_surrogates
from cg2raw.short_messages import about, shortened


def check_words(words: Sequence[str]) -> None:
    """Raise ValueError for a word that is no UTF-8; the core takes no other names."""
    for word in words:
        if has_surrogates(word):
            raise ValueError(shortened(f"{word!a} is no UTF-8; rename the file"))


def about_output(arguments: argparse.Namespace, error: BaseException) -> str:
    """Return an exception's message for a command, by short_messages.about."""
    output = getattr(arguments, "output", None) or getattr(arguments, "out", None)
    return about(output, error)
