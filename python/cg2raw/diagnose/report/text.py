# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Numbers and sentences of the report. A number that is not known reads "unknown"."""

import math
from typing import TypeGuard

from cg2raw.diagnose.diagnosis import Diagnosis, Estimate
from cg2raw.diagnose.effects.catalogue import heading, title

NOT_KNOWN = "unknown"
MINUS = "\N{MINUS SIGN}"
TIMES = "\N{MULTIPLICATION SIGN}"
NARROW_SPACE = "\N{NARROW NO-BREAK SPACE}"
SUPERSCRIPT = str.maketrans(
    "0123456789-",
    "\N{SUPERSCRIPT ZERO}\N{SUPERSCRIPT ONE}\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}"
    "\N{SUPERSCRIPT FOUR}\N{SUPERSCRIPT FIVE}\N{SUPERSCRIPT SIX}\N{SUPERSCRIPT SEVEN}"
    "\N{SUPERSCRIPT EIGHT}\N{SUPERSCRIPT NINE}\N{SUPERSCRIPT MINUS}",
)


def is_known(value: float | None) -> TypeGuard[float]:
    """Whether @value is a finite number."""
    return value is not None and math.isfinite(value)


def number(value: float | None, digits: int = 3) -> str:
    """Return @value with so many significant digits; powers of ten beyond 1e-4, 1e6."""
    if value is None or not math.isfinite(value):
        return NOT_KNOWN
    if value == 0:
        return "0"
    scientific = f"{value:.{digits - 1}e}"
    mantissa, _, power = scientific.partition("e")
    exponent = int(power)
    if not -4 <= exponent < 6:
        return f"{mantissa}{TIMES}{power_of_ten(exponent)}".replace("-", MINUS)
    return decimal(float(scientific), max(0, digits - 1 - exponent))


def nats(value: float | None) -> str:
    """Return a log-likelihood: tenths of a nat are the last that matter."""
    if not is_known(value) or abs(value) >= 1e6:
        return number(value, 4)
    return decimal(value, 1 if abs(value) < 1000 else 0)


def decimal(value: float, places: int) -> str:
    """Return @value with so many decimals, thousands apart, with a true minus sign."""
    text = f"{value:,.{places}f}".replace(",", NARROW_SPACE)
    return (
        text.replace("-", MINUS) if float(f"{value:.{places}f}") else text.lstrip("-")
    )


def power_of_ten(exponent: int) -> str:
    """Return 10 with a raised exponent."""
    return "10" + str(exponent).translate(SUPERSCRIPT)


def places_of(half_width: float, value: float) -> int | None:
    """Return the decimals that an interval of that half width deserves, or None."""
    if not (math.isfinite(half_width) and half_width > 0):
        return None
    places = 1 - math.floor(math.log10(half_width))
    return places if places <= 6 and abs(value) < 1e6 else None


def estimate(parameter: Estimate) -> tuple[str, str]:
    """Return a parameter's value and interval, to the digits that this one gives."""
    low, high = parameter.ci95
    places = places_of((high - low) / 2, parameter.value)
    if places is None or not is_known(parameter.value):
        return number(parameter.value, 4), interval((low, high))
    places = max(0, places)
    shown = [decimal(x, places) for x in (parameter.value, low, high)]
    return shown[0], f"{shown[1]} to {shown[2]}"


def interval(bounds: tuple[float, float] | None, digits: int = 3) -> str:
    """Return "low to high", or "unknown"."""
    if bounds is None or not all(is_known(bound) for bound in bounds):
        return NOT_KNOWN
    return f"{number(bounds[0], digits)} to {number(bounds[1], digits)}"


def listed(names: list[str], last: str = "and") -> str:
    """Return "a, b and c"."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


NUMERALS = (
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
)


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in one short sentence."""
    more = sum(one.stated for one in diagnosis.effects)
    count = len(diagnosis.effects) - more
    match diagnosis.verdict:
        case "consistent":
            return "Nothing in these frames contradicts the profile"
        case "unexplained":
            return "The frames differ from the profile, and no known effect explains it"
        case "incomplete":
            return "The diagnosis ended before all was decided"
    if count + more == 1:
        name = heading(diagnosis.effects[0].name)
        return f"{name} " + (
            "is not as the profile says" if more else "is missing from the profile"
        )
    parts = []
    if count or not more:
        verb = "is" if count == 1 else "are"
        noun = "effect" if count == 1 else "effects"
        parts.append(f"{counted_words(count)} {noun} {verb} missing from the profile")
    if more:
        verb = "is" if more == 1 else "are"
        noun = "" if parts else (" effect" if more == 1 else " effects")
        tail = "it says" if parts else "the profile says"
        parts.append(f"{counted_words(more)}{noun} {verb} not as {tail}")
    words = " and ".join(parts)
    return words[:1].upper() + words[1:]


def counted_words(count: int) -> str:
    """Return a number of things in words, up to nine."""
    return NUMERALS[count] if count < len(NUMERALS) else str(count)


def summary(diagnosis: Diagnosis) -> str:
    """Return the names, and what is left, in two sentences at most."""
    doubts = [
        listed([title(n) for n in (one.name, *one.ambiguous_with)], "or")
        for one in diagnosis.effects
        if one.ambiguous_with
    ]
    names = listed([title(one.name) for one in diagnosis.effects])
    first = f"{names[:1].upper()}{names[1:]}. " if len(diagnosis.effects) > 1 else ""
    match diagnosis.verdict:
        case "ambiguous" if doubts:
            return f"{first}These frames cannot tell {'; nor '.join(doubts)}."
        case "explained" | "consistent" | "ambiguous":
            with_them = {0: "The", 1: "With it, the"}.get(
                len(diagnosis.effects), "With them, the"
            )
            rest = "residuals of the test frames cannot be told from noise."
            return f"{first}{with_them} {rest}"
        case "incomplete":
            return f"{first}More may be missing." if first else "More may be missing."
    return f"{first}{left(diagnosis)}"


def left(diagnosis: Diagnosis) -> str:
    """Return the largest residual that no effect explains."""
    largest = max(
        diagnosis.unexplained,
        key=lambda test: test.nats_per_pixel if is_known(test.nats_per_pixel) else 0,
    )
    names = ", and the names are provisional" if diagnosis.effects else ""
    return f"Most of what is left is in: {title(largest.name)}{names}."


def duration(seconds: float) -> str:
    """Return a duration in s, or in min and s."""
    if not is_known(seconds) or seconds < 60:
        return f"{number(seconds)} s"
    return f"{int(seconds // 60)} min {int(seconds % 60)} s"
