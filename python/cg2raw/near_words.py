# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What a mistyped sensor, illuminant or option was probably meant to be.

The core knows which words there are; every message of it is read as a _core.Error,
whose text has a hint added here, wherever it is shown."""

import difflib
import re
from collections.abc import Sequence

from cg2raw import _core

LONGEST = 1500  # bytes of a message
# What ends a line or steers a terminal, and half of a pair.
CONTROLS = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")
MOST = 3  # words that a message suggests
CLOSE, HARDLY = 0.7, 0.05  # ratios of difflib
DAYLIGHTS = ("D50", "D55", "D65", "D75")
LEAST_KELVIN, MOST_KELVIN = 1667.0, 25000.0  # of illuminant_grammar
# The CIE's fluorescent, LED and high pressure lamps. Source: CIE 015, tables 10 and 12.
CIE_LAMPS = (
    *(f"FL{number}" for number in range(1, 13)),
    *(f"LED-B{number}" for number in range(1, 6)),
    *("LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
    *(f"HP{number}" for number in range(1, 6)),
)
FORMS = ("sample", "measured", "neutral", "lamp", "as-shot", "xy")
# By the temperatures that the DNG SDK has for Exif's LightSource.
NAMES = {
    "tungsten": "A",
    "incandescent": "A",
    "daylight": "D55",
    "flash": "D55",
    "cloudy": "D65",
    "shade": "D75",
}

SENSOR = re.compile(r'unknown sensor "(.*?)"; installed: (.*?); or give the path', re.S)
ILLUMINANT = re.compile(
    r'unknown illuminant "(.*?)"; it may be: ' + re.escape(_core.illuminant_grammar),
    re.S,
)
# Of an export, as _core.ExportOptions says it in a command's words.
OPTION = re.compile(r"(--\S+) is unknown; known: (--.*)", re.S)


def bare(word: str) -> str:
    """Return a word's letters and digits, in lower case."""
    return re.sub(r"[^a-z0-9]", "", word.lower())


def near_sensors(word: str, ids: Sequence[str]) -> list[str]:
    """Return those of @ids that @word may stand for, the likeliest first.

    Case, hyphens and spaces do not count. A part of an id is near to it, and so is a
    word that is like a part."""
    asked = bare(word)
    if not asked:
        return []
    whole = {bare(id): id for id in ids}
    if asked in whole:
        return [whole[asked]]
    found = [id for name, id in whole.items() if asked in name]
    found = found or [whole[name] for name in _close(asked, list(whole))]
    parts = {part for id in ids for part in id.split("-")}
    like = [] if found else _close(asked, sorted(parts))[:1]
    return (found or [id for id in ids if like and like[0] in id.split("-")])[:MOST]


def near_illuminants(word: str) -> list[str]:
    """Return words of the illuminant grammar that @word may stand for."""
    asked = bare(word)
    if number := re.fullmatch(r"(\d+(?:\.\d+)?) *(?:k|kelvin)?", word.strip().lower()):
        in_range = LEAST_KELVIN <= float(number[1]) <= MOST_KELVIN
        return [f"{number[1]}K"] if in_range else []
    if daylight := re.fullmatch(r"d(\d\d)(?:00)?", asked):
        return _near_daylights(int(daylight[1]))
    if asked in NAMES:
        return [NAMES[asked]]
    known = {bare(name): name for name in (*DAYLIGHTS, *CIE_LAMPS)}
    if asked in known:
        return [known[asked]]
    head, colon, rest = word.partition(":")
    close = difflib.get_close_matches(head.strip().lower(), FORMS, 1)
    return [close[0] + colon + rest] if close and close[0] != head else []


def did_you_mean(words: Sequence[str]) -> str:
    """Return "did you mean a, b or c?" of at least one word."""
    *first, last = words
    return f"did you mean {', '.join(first)}{' or ' if first else ''}{last}?"


def with_suggestion(message: str) -> str:
    """Return a message of the core with the words that may have been meant."""
    for pattern, words in (
        (SENSOR, _sensor_words),
        (ILLUMINANT, _illuminant_words),
        (OPTION, _option_words),
    ):
        message = pattern.sub(words, message)
    return message


def one_line(message: str) -> str:
    """Return a message as one line, whatever it repeats of a stranger's text; of a long
    one the start and the end."""
    line = CONTROLS.sub("?", message)
    data = line.encode()
    if len(data) <= LONGEST:
        return line
    start, end = data[: LONGEST // 2], data[-LONGEST // 2 :]
    return f"{start.decode(errors='ignore')} ... {end.decode(errors='ignore')}"


def _read(error: BaseException) -> str:
    """Return the message of a _core.Error with a suggestion, and not too long: its
    start and end, where it repeats what it was given."""
    return one_line(with_suggestion(one_line(BaseException.__str__(error))))


def _sensor_words(found: re.Match[str]) -> str:
    near = near_sensors(found[1], found[2].split(", "))
    hint = f"; {did_you_mean(near)} installed" if near else "; installed"
    return f'unknown sensor "{found[1]}"{hint}: {found[2]}; or give the path'


def _illuminant_words(found: re.Match[str]) -> str:
    word = found[1] if re.fullmatch(r"\S+", found[1]) else f'"{found[1]}"'
    near = near_illuminants(found[1])
    hint = did_you_mean(near) if near else f"it may be: {_core.illuminant_grammar}"
    return f"unknown illuminant {word}; {hint}"


def _option_words(found: re.Match[str]) -> str:
    near = _close(found[1], found[2].split(", "))
    hint = f"; {did_you_mean(near)} known" if near else "; known"
    return f"{found[1]} is unknown{hint}: {found[2]}"


def _near_daylights(number: int) -> list[str]:
    """Return the daylights of the nearest number, and of its digits the other way."""
    numbers = {name: int(name[1:]) for name in DAYLIGHTS}
    least = min(abs(other - number) for other in numbers.values())
    turned = number % 10 * 10 + number // 10
    return [n for n, o in numbers.items() if abs(o - number) == least or o == turned]


def _close(word: str, known: Sequence[str]) -> list[str]:
    """Return the closest words, and those that are hardly less close."""
    close = difflib.get_close_matches(word, known, MOST, cutoff=CLOSE)
    ratio = {name: difflib.SequenceMatcher(None, name, word).ratio() for name in close}
    return [name for name in close if ratio[name] >= ratio[close[0]] - HARDLY]


_core.Error.__str__ = _read  # type: ignore[method-assign]
