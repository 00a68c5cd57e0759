# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Numbers on a command line."""

import argparse
import math
import re
from collections.abc import Callable
from typing import Any

MOST_SEED = 2**64 - 1


def number(low: float, high: float) -> Callable[[str], float]:
    """Return a parser of numbers from @low to @high, for argparse."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(
                f"{text}: must be a number from {low:g} to {high:g}"
            )
        return value

    return parse


def whole(text: str) -> int:
    """Return the whole number that @text is."""
    if not re.fullmatch("[0-9]{1,20}", text) or int(text) > MOST_SEED:
        raise argparse.ArgumentTypeError(
            f"{text}: must be a whole number from 0 to {MOST_SEED}"
        )
    return int(text)


def number_list(option: str, words: str, word: str = "") -> list[Any]:
    """Return the floats of a list, and @word as it is. Raises ValueError."""
    found: list[float | str] = []
    form = f"a number or {word}, as in {word},100" if word else "a number, as in -2,0,2"
    for text in words.split(","):
        try:
            is_word = word and text.strip() == word
            value = text.strip() if is_word else float(text)
        except ValueError:
            raise ValueError(f"{option} {text}: must be {form}") from None
        if value in found:
            raise ValueError(f"{option} {text}: is there twice; name it once")
        found.append(value)
    return found
