# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parsing of words on the command line, and error messages."""

from collections.abc import Sequence


def check_words(words: Sequence[str]) -> None:
    """Raise ValueError for a word that is no UTF-8; the core takes no other names."""
    for word in words:
        if not word.isascii() and word != word.encode(errors="replace").decode():
            raise ValueError(f"{word!a} is no UTF-8; rename the file")


def words_of(error: BaseException) -> str:
    """Return an exception's message in one line, what it is about first."""
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        message = f"{error.filename}: {error.strerror}"
    else:
        message = str(error)
    return " ".join(message.splitlines())
