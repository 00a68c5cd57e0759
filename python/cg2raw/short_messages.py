# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Messages that stay short whatever the words that they repeat."""

import argparse
from typing import NoReturn

MOST = 1900  # letters of a message


def shortened(message: str) -> str:
    """Return a message without its middle if it is long: it begins with what it is
    about and ends with the reason."""
    if len(message) <= MOST:
        return message
    return f"{message[: MOST // 2]} ... {message[-MOST // 3 :]}"


class Parser(argparse.ArgumentParser):
    """A parser whose errors are short, whatever the words."""

    def error(self, message: str) -> NoReturn:
        """Print usage and message, and exit with 2."""
        super().error(shortened(" ".join(message.splitlines())))
