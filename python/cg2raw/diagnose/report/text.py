# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Numbers and sentences of the report. A number that is not known reads "unknown"."""

import math
from typing import TypeGuard

from cg2raw.diagnose.diagnosis import LARGEST_E, Diagnosis, Estimate, Gap
from cg2raw.diagnose.effects.catalogue import title
from cg2raw.short_messages import plural

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
# Words for an e-value: its decades as Jeffreys divides those of Bayes factors.
# Source: Jeffreys, Theory of Probability, 3rd edition 1961, appendix B.
STRENGTHS = (
    (100.0, "decisive"),
    (10**1.5, "very strong"),
    (10.0, "strong"),
    (10**0.5, "substantial"),
    (1.0, "barely worth mentioning"),
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


def counted(count: int, noun: str) -> str:
    """Return how many there are of a thing, in whole numbers: "2 held-out darks"."""
    if not is_known(count):
        return f"{NOT_KNOWN} {noun}s"
    return plural(int(count), noun).replace(str(count), decimal(count, 0), 1)


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


def unit(name: str) -> str:
    """Return a unit as it follows a number: the unit 1 is silent."""
    return "" if name in ("1", "") else name


def plain(name: str) -> str:
    """Return an effect's or test's name as words."""
    return title(name)


def listed(names: list[str], last: str = "and") -> str:
    """Return "a, b and c"."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


def be(names: list[str]) -> str:
    return "is" if len(names) < 2 else "are"


def closed(gap: Gap) -> float | None:
    """Return the closed share of the gap, 0..1 of it, or None where there was none."""
    if not (is_known(gap.before) and is_known(gap.after)) or gap.before <= 0:
        return None
    return 1 - max(0.0, gap.after) / gap.before


def percent(share: float | None) -> str:
    """Return a share in percent, rounded down: what is nearly all is never "100 %"."""
    if share is None or not math.isfinite(share):
        return NOT_KNOWN
    if share >= 1:
        return "100 %"
    return f"{math.floor(share * 1e4) / 100:.2f} %".replace("-", MINUS)


def rough_percent(share: float | None) -> str:
    """Return a share in percent with two significant digits."""
    return f"{number(100 * share, 2)} %" if is_known(share) else NOT_KNOWN


def evidence(e_value: float) -> tuple[str, str]:
    """Return an e-value, and what it says in words."""
    if not is_known(e_value):
        return NOT_KNOWN, "The strength of the evidence is not known."
    is_largest = e_value >= LARGEST_E
    shown = f"at least {power_of_ten(300)}" if is_largest else number(e_value, 2)
    strength = next((word for least, word in STRENGTHS if e_value >= least), "none")
    if strength == "none":
        return shown, "No evidence: the frames speak against this effect."
    odds = f"1 in {power_of_ten(math.floor(math.log10(e_value)))}"
    odds = f"1 in {number(e_value, 2)}" if e_value < 1e4 else odds
    return shown, (
        f"{strength.capitalize()}: without this effect, evidence as strong would come "
        f"by chance in at most {odds} capture sets."
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict in one plain sentence."""
    sensor = diagnosis.sensor_id
    what = what_was_found(diagnosis)
    match diagnosis.verdict:
        case "consistent":
            text = f"nothing in these frames contradicts the profile {sensor}"
        case "explained":
            text = what
        case "partially_explained":
            text = f"{what}, but something that no known effect explains is left, so "
            text += "the names are provisional"
        case "ambiguous":
            text = ambiguity(diagnosis, sensor)
        case "unexplained":
            text = f"the frames disagree with the profile {sensor} in a way that no "
            text += f"known effect explains{unexplained(diagnosis)}"
        case "incomplete":
            text = f"the search for what is missing from the profile {sensor} ended "
            text += "before it had decided: "
            text += what if diagnosis.effects else "it has named nothing so far"
        case other:
            text = f"the verdict is: {other}"
    return text[:1].upper() + text[1:] + "."


def what_was_found(diagnosis: Diagnosis) -> str:
    """Return what is missing from the profile, and of what it says something wrong."""
    corrected = {r.name for r in diagnosis.ladder if r.action == "contradicted"}
    names = [effect.name for effect in diagnosis.effects]
    lacks = [plain(name) for name in names if name not in corrected]
    wrong = [plain(name) for name in names if name in corrected]
    profile, parts = f"the profile {diagnosis.sensor_id}", []
    if lacks or not wrong:
        text = f"{listed(lacks) or 'nothing'} {be(lacks)} missing from {profile}"
        share, them = closed(diagnosis.gap), "it" if len(lacks) < 2 else "them"
        if share is not None:
            text += f"; adding {them} closes {percent(share)} of the gap"
        parts, profile = [text], "it"
    if wrong:
        parts.append(f"{listed(wrong)} {be(wrong)} not as strong as {profile} says")
    return "; ".join(parts)


def ambiguity(diagnosis: Diagnosis, sensor: str) -> str:
    """Return which names these frames cannot tell apart."""
    doubts = [
        listed([plain(n) for n in (effect.name, *effect.ambiguous_with)], "or")
        for effect in diagnosis.effects
        if effect.ambiguous_with
    ]
    if not doubts:
        return f"the frames do not decide what is missing from the profile {sensor}"
    return (
        f"{listed(doubts)} is missing from the profile {sensor}: these frames cannot "
        "tell which"
    )


def unexplained(diagnosis: Diagnosis) -> str:
    """Return the largest unexplained residual as the end of a sentence."""
    if not diagnosis.unexplained:
        return ""
    largest = max(
        diagnosis.unexplained,
        key=lambda test: test.nats_per_pixel if is_known(test.nats_per_pixel) else 0,
    )
    return f"; it shows most in: {plain(largest.name)}"


def duration(seconds: float) -> str:
    """Return a duration in s, or in min and s."""
    if not is_known(seconds) or seconds < 60:
        return f"{number(seconds)} s"
    return f"{int(seconds // 60)} min {int(seconds % 60)} s"
