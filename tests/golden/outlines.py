# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Golden files: what a command wrote when it was last looked at, in a form that people
can compare.

Words are as they were; a number may differ by its rounding. Of many numbers, as of a
curve, and of the pixels of a picture, there are some sums alone. After a change that is
wanted, `CG2RAW_UPDATE_GOLDEN=1 pytest FILE` writes them anew: read the difference.
"""

import base64
import io
import json
import math
import os
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from itertools import zip_longest
from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).parent
NUMBER = re.compile(r"[-\u2212]?\d+(?:\.\d+)?(?:[eE][-+]?\d{1,3}\b)?")
HASH = re.compile(r"\b[0-9a-f]{16,}\b")
FEW = 8  # numbers that are listed
WIDTH = 240  # characters of a line of JSON
RELATIVE = 1e-5
PNG = re.compile("data:image/png;base64,([A-Za-z0-9+/=]+)")


def check(name: str, lines: list[str]) -> None:
    """Fail unless lines are those of a golden file."""
    path = FOLDER / f"{name}.txt"
    if os.environ.get("CG2RAW_UPDATE_GOLDEN") == "1":
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    old = path.read_text(encoding="utf-8").splitlines()
    for number, (was, now) in enumerate(zip_longest(old, lines), 1):
        assert are_alike(was, now), f"{path.name}:{number}\n- {was}\n+ {now}"


def are_alike(was: str | None, now: str | None) -> bool:
    """Return whether lines differ by the rounding of their numbers at most."""
    if was is None or now is None or NUMBER.sub("#", was) != NUMBER.sub("#", now):
        return False
    pairs = zip(NUMBER.findall(was), NUMBER.findall(now), strict=True)
    return all(abs(of(a) - of(b)) <= rounding(a) for a, b in pairs)


def of(number: str) -> float:
    return float(number.replace("\u2212", "-"))


def rounding(number: str) -> float:
    """Return by how much a number may differ: by one of its last digit, as another
    processor rounds; by less where it has many."""
    mantissa, _, exponent = number.lower().partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    size = abs(of(number))
    if len(mantissa) < 8 or size == 0:
        return 1.01 * unit
    return size * RELATIVE * (1 + abs(math.log(size)))


def summary(numbers: Iterator[float] | list[float]) -> str:
    """Return sums of many numbers, in which each of them shows."""
    x = np.array([*numbers], float)
    x = x[np.isfinite(x)]
    mix = np.cos(np.arange(x.size))
    sums = (x.mean(), x.std(), np.average(x * mix)) if x.size else ()
    return " ".join([f"({x.size} numbers)", *(f"{one:.5g}" for one in sums)])


def of_text(text: str) -> str:
    """Return text of few numbers as it is, of more by their sums."""
    text = PNG.sub(lambda found: of_png(base64.b64decode(found[1])), text)
    text = HASH.sub(lambda found: in_letters(found[0]), text)
    found = NUMBER.findall(text)
    if len(found) <= FEW:
        return text
    words = re.sub(r"(?:# *[,;]? *)+", "# ", NUMBER.sub("#", text))
    return f"{words[:80]} {summary(map(of, found))}"


def in_letters(digest: str) -> str:
    """Return a hash without digits, which are no numbers."""
    return digest.translate(str.maketrans("0123456789", "ghijklmnop"))


def of_png(data: bytes) -> str:
    """Return the size of a picture and sums of its pixels, 1 at white."""
    with Image.open(io.BytesIO(data)) as image:
        levels = np.asarray(image.convert("RGB"), float) / 255
    return f"{levels.shape} {summary(levels.ravel().tolist())}"


def of_json(text: str) -> list[str]:
    """Return lines of JSON: as much of it in each as is short."""

    def lines(value: object, path: str) -> Iterator[str]:
        short = said(value)
        if len(short) <= WIDTH:
            yield f"{path}: {short}"
        elif isinstance(value, dict):
            for key, one in value.items():
                yield from lines(one, f"{path}.{key}" if path else key)
        elif isinstance(value, list) and re.search(r'["{]', short):
            for n, one in enumerate(value):
                yield from lines(one, f"{path}[{n}]")
        else:
            yield f"{path}: {of_text(short)}"

    return [*lines(json.loads(text), "")]


def said(value: object) -> str:
    """Return a value of JSON in a line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {said(one)}" for k, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(said, value)) + "]"
    return f"{value:.10g}" if isinstance(value, float) else json.dumps(value)


class Outline(HTMLParser):
    """The elements of a page and its words, a line each; a line for a row of a table;
    of a drawing, a line for all elements that differ by numbers alone. Not its style
    sheet."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []
        self.row: list[str] | None = None  # of the drawing or row that is open
        self.is_style = False

    def handle_starttag(self, tag, attrs):
        self.is_style = tag == "style"
        words = [f'{key}="{value or ""}"' for key, value in attrs]
        if tag in ("svg", "tr"):
            self.row = []
        lines = self.lines if self.row is None else self.row
        lines.append(of_text(" ".join([f"<{tag}", *words]) + ">"))

    def handle_endtag(self, tag):
        self.is_style = False
        if tag in ("svg", "tr") and self.row is not None:
            row, self.row = self.row, None
            self.lines += [" ".join(row)] if tag == "tr" else alike_in_one(row)

    def handle_data(self, data):
        if data.strip() and not self.is_style:
            lines = self.lines if self.row is None else self.row
            lines[-1] += " " + of_text(" ".join(data.split()))


def alike_in_one(lines: list[str]) -> list[str]:
    """Return a line in place of all that differ by numbers alone."""
    groups: dict[str, list[str]] = {}
    for line in lines:
        groups.setdefault(NUMBER.sub("#", line), []).append(line)
    return [of_text(" ".join(one)) for one in groups.values()]


def of_html(text: str) -> list[str]:
    """Return the outline of a page."""
    outline = Outline()
    outline.feed(text)
    return outline.lines


def of_file(path: Path) -> list[str]:
    """Return the outline of a file by its kind."""
    if path.suffix == ".png":
        return [of_png(path.read_bytes())]
    text = path.read_text(encoding="utf-8")
    by_kind = {".json": of_json, ".html": of_html}
    return by_kind.get(path.suffix, of_lines)(text)


def of_lines(text: str) -> list[str]:
    """Return lines of text; of a long one's many numbers, their sums."""
    return [of_text(x) if len(x) > WIDTH else x for x in text.splitlines()]
