# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parsing of words on the command line, and error messages."""

import argparse
from collections.abc import Sequence

from cg2raw.core_arguments import NO_MEMORY, has_surrogates
from cg2raw.short_messages import shortened


def check_words(words: Sequence[str]) -> None:
    """Raise ValueError for a word that is no UTF-8; the core takes no other names."""
    for word in words:
        if has_surrogates(word):
            raise ValueError(shortened(f"{word!a} is no UTF-8; rename the file"))


def words_of(error: BaseException) -> str:
    """Return an exception's message in one line, what it is about first."""
    if isinstance(error, MemoryError):
        message = str(error).replace("std::bad_alloc", NO_MEMORY) or NO_MEMORY
    elif isinstance(error, OSError) and error.strerror:
        named = error.filename is not None
        message = f"{error.filename}: {error.strerror}" if named else error.strerror
    else:
        message = str(error)
    return shortened(" ".join(message.splitlines()))


def about(arguments: argparse.Namespace, error: BaseException) -> str:
    """Return an exception's message for a command, led by its output if the message is
    about no file: memory that ends, or an open file of which the system said no."""
    words = words_of(error)
    path = getattr(arguments, "output", None) or getattr(arguments, "out", None)
    is_of_system = isinstance(error, MemoryError) or (
        isinstance(error, OSError) and bool(error.strerror) and error.filename is None
    )
    return f"{path}: {words}" if path and is_of_system and ": " not in words else words
