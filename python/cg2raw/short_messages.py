# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Messages that stay short whatever the words that they repeat."""

import argparse
from typing import NoReturn

MOST = 1900  # letters of a message
NO_MEMORY = "not enough memory"  # where C++ says std::bad_alloc


def shortened(message: str) -> str:
    """Return a message without its middle if it is long: it begins with what it is
    about and ends with the reason."""
    if len(message) <= MOST:
        return message
    return f"{message[: MOST // 2]} ... {message[-MOST // 3 :]}"


def plural(count: int, noun: str) -> str:
    """Return how many there are of a thing: "1 dark", "2 darks", "0 darks"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


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


def about(output: str | None, error: BaseException) -> str:
    """Return an exception's message, led by the output if it is about no file: memory
    that ends, or an open file of which the system said no."""
    words = words_of(error)
    is_of_system = isinstance(error, MemoryError) or (
        isinstance(error, OSError) and bool(error.strerror) and error.filename is None
    )
    return (
        f"{output}: {words}" if output and is_of_system and ": " not in words else words
    )


class Parser(argparse.ArgumentParser):
    """A parser whose errors are short, whatever the words."""

    def error(self, message: str) -> NoReturn:
        """Print usage and message, and exit with 2."""
        super().error(shortened(" ".join(message.splitlines())))
