# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Small charts as SVG, for pages: without a library, readable without colour.

Labels stand where no data are: the legend above the axes, as many ticks as have room.
The same numbers give the same bytes."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

WIDTH, HEIGHT = 420, 214
LEFT, RIGHT, TOP, BOTTOM = 58, 408, 44, 168
LETTER = 8.0  # px of width of most letters
DOT, LINE, APART = 16, 26, 12  # px of a legend: before a label, and after it
ROW = 22  # px of a row of bars
NAMED = 140  # px for names of bars
MOST_TICKS = 6
# Ink for what is measured; before and after differ for all common colour vision.
INK, BEFORE, AFTER = "#1b1f24", "#c2410c", "#0f766e"
# Sites of a CFA, in the order of their names: both greens of a Bayer CFA differ.
SITES = {
    "R": "#c62828",
    "G": "#2e7d32",
    "Gr": "#1b5e20",
    "Gb": "#5a9216",
    "B": "#1565c0",
}
DASHES = {"solid": "", "dashed": "7 4", "dotted": "2 3"}
SHAPES = ("circle", "square", "diamond", "triangle")


@dataclass(frozen=True)
class Mark:
    """One thing that is drawn: (n,) x and y; none if it is in the legend alone.

    style : "dots", a key of DASHES, or "band" of y to either side of 0. label : in the
    legend; "" for none. shape : of dots."""

    label: str
    x: Array
    y: Array
    style: str
    color: str = INK
    shape: str = "circle"

    @property
    def points(self) -> Array:
        """(m, 2) of those that are numbers."""
        both = np.array([self.x, self.y], float).T
        found: Array = both[np.isfinite(both).all(axis=1)]
        return found


@dataclass(frozen=True)
class Axis:
    """Numbers from low to high on pixels from start to end."""

    low: float
    high: float
    start: float
    end: float
    is_log: bool = False

    def at(self, values: Any) -> Array:
        """Return the pixels of values."""
        low, high, x = self.low, self.high, np.asarray(values, float)
        if self.is_log:
            low, high, x = math.log(low), math.log(high), np.log(x)
        found: Array = self.start + (x - low) / (high - low) * (self.end - self.start)
        return found

    @property
    def ticks(self) -> list[float]:
        """Round numbers within, at most MOST_TICKS but for some."""
        if not self.is_log:
            return steps(self.low, self.high)
        first, last = math.ceil(math.log10(self.low)), math.log10(self.high)
        decades = range(first, math.floor(last + 1e-9) + 1)
        if len(decades) < 2:
            return [x for x in steps(self.low, self.high) if x >= self.low > 0]
        return [10.0**n for n in decades[:: -(-len(decades) // MOST_TICKS)]]


def steps(low: float, high: float) -> list[float]:
    """Return multiples of 1, 2 or 5 times a power of ten from @low to @high."""
    rough = (high - low) / (MOST_TICKS - 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(n * power for n in (1, 2, 5, 10) if n * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)]


def tick_words(ticks: Sequence[float]) -> list[str]:
    """Return ticks in words, each with as many digits as tell them apart."""
    for digits in range(6, 16):
        words = [f"{x + 0.0:.{digits}g}" for x in ticks]
        if len(set(words)) == len(words):
            break
    return [one.replace("-", "\N{MINUS SIGN}") for one in words]


def axis(values: Array, start: float, end: float, is_log: bool, room: float) -> Axis:
    """Return an axis on which values have room beyond their ends."""
    known = values[np.isfinite(values)]
    low, high = float(known.min()), float(known.max())
    if is_log:
        low, high = low / 10**room, high * 10**room
        return Axis(low, max(high, low * 1.5), start, end, True)
    half = max((high - low) * room, abs(high) * 1e-6, 1e-12 if high == low else 0.0)
    low_end = 0.0 if 0 <= low < 0.35 * high else low - half
    high_end = 0.0 if 0 >= high > 0.35 * low else high + half
    return Axis(low_end, high_end, start, end)


def lines(
    title: str, marks: Sequence[Mark], labels: tuple[str, str], scale: str = ""
) -> str:
    """Return the SVG of marks over x; "" if there is nothing to draw.

    title : what is drawn, in words. labels : of x and y. scale : "log" or "linear"
    of x and of y."""
    x_log, y_log = [word == "log" for word in (scale or "linear linear").split()]
    marks = [on_scale(mark, x_log, y_log) for mark in marks]
    drawn = [mark.points for mark in marks if len(mark.points)]
    if not drawn:
        return ""
    drawn += [mark.points * (1, -1) for mark in marks if mark.style == "band"]
    every = np.concatenate(drawn)
    x = axis(every[:, 0], LEFT, RIGHT, x_log, 0.0 if not x_log else 0.02)
    y = axis(every[:, 1], BOTTOM, TOP, y_log, 0.08)
    parts = [*axes(x, y, labels), *legend(marks, labels[1])]
    for mark in marks:
        if len(mark.points):
            parts += drawing(mark, x, y)
    return svg(title, parts, HEIGHT)


def on_scale(mark: Mark, x_log: bool, y_log: bool) -> Mark:
    """Return a mark without what a logarithmic axis has no place for."""
    x, y = np.asarray(mark.x, float), np.asarray(mark.y, float)
    legal = ((x > 0) | (not x_log)) & ((y > 0) | (not y_log))
    return replace(mark, x=x[legal], y=y[legal])


def axes(x: Axis, y: Axis, labels: tuple[str, str]) -> Iterator[str]:
    """Yield grid, ticks and labels."""
    ticks = [tick for tick in y.ticks if y.low <= tick <= y.high] or [y.low, y.high]
    for tick, words in zip(ticks, tick_words(ticks), strict=True):
        at = float(y.at(tick))
        yield f'<path class="grid" d="M{LEFT} {at:.1f}H{RIGHT}"/>'
        yield text(LEFT - 7, at + 4, words, "end")
    yield f'<path class="axis" d="M{LEFT} {BOTTOM}H{RIGHT}"/>'
    ticks, end = x.ticks, -math.inf
    for tick, words in zip(ticks, tick_words(ticks), strict=True):
        at, half = float(x.at(tick)), LETTER * len(words) / 2
        if at - half > end and LEFT - 1 <= at <= RIGHT + 1:
            end = at + half + LETTER
            yield f'<path class="axis" d="M{at:.1f} {BOTTOM}v4"/>'
            yield text(at, BOTTOM + 18, words, "middle")
    yield text((LEFT + RIGHT) / 2, HEIGHT - 8, labels[0], "middle")
    yield text(4, 14, labels[1], "start")


def legend(marks: Sequence[Mark], beside: str) -> Iterator[str]:
    """Yield the entries of a legend, in the row below the label of y."""
    named = [mark for mark in marks if mark.label]
    shifts = [DOT if mark.style == "dots" else LINE for mark in named]
    widths = [
        shift + LETTER * len(mark.label) + APART
        for shift, mark in zip(shifts, named, strict=True)
    ]
    width = sum(widths)
    at, row = max(min(float(LEFT), WIDTH - width), 4.0), 32
    if 12 + LETTER * len(beside) + width < WIDTH:  # there is room in its row
        at, row = WIDTH - width, 14
    for mark, shift, width in zip(named, shifts, widths, strict=True):
        yield swatch(mark, at, row - 4)
        yield text(at + shift, row, mark.label, "start", mark.color)
        at += width


def swatch(mark: Mark, x: float, y: float) -> str:
    """Return a piece of a mark for a legend."""
    if mark.style == "dots":
        return dot(x + 6, y, mark)
    if mark.style == "band":
        return (
            f'<rect x="{x:.1f}" y="{y - 5:.1f}" width="20" height="10" {fill(mark)}/>'
        )
    return f'<path d="M{x:.1f} {y:.1f}h20" {stroke(mark)}/>'


def drawing(mark: Mark, x: Axis, y: Axis) -> Iterator[str]:
    """Yield what a mark looks like."""
    points = mark.points
    across, down = x.at(points[:, 0]), y.at(points[:, 1])
    if mark.style == "dots":
        for place in zip(across, down, strict=True):
            yield dot(*place, mark)
        return
    places = [*zip(across, down, strict=True)]
    if mark.style == "band":
        other = y.at(-points[:, 1])[::-1]
        ends = (points[:, 0].min(), points[:, 0].max())
        if ends[0] == ends[1]:
            return
        places = [*places, *zip(across[::-1], other, strict=True)]
        at = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
        yield f'<polygon points="{at}" {fill(mark)}/>'
        return
    at = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
    yield f'<polyline points="{at}" {stroke(mark)}/>'


def dot(x: float, y: float, mark: Mark) -> str:
    """Return one point."""
    path = {
        "square": "m-3 -3h6v6h-6z",
        "diamond": "m0 -4.4l4.4 4.4l-4.4 4.4l-4.4 -4.4z",
        "triangle": "m0 -4.4l4.2 7.4h-8.4z",
    }.get(mark.shape)
    if path is None:
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.4" fill="{mark.color}"/>'
    return f'<path d="M{x:.1f} {y:.1f}{path}" fill="{mark.color}"/>'


def stroke(mark: Mark) -> str:
    """Return how a line is drawn."""
    dashes = DASHES[mark.style]
    pattern = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'fill="none" stroke="{mark.color}" stroke-width="2.2"{pattern}'


def fill(mark: Mark) -> str:
    """Return how a band is filled: the edge of a prediction without is dashed."""
    edge = ' stroke-dasharray="7 4"' if mark.color == BEFORE else ""
    return (
        f'fill="{mark.color}" fill-opacity=".16" stroke="{mark.color}" '
        f'stroke-width="1"{edge}'
    )


def bars(title: str, names: Sequence[str], marks: Sequence[Mark], label: str) -> str:
    """Return the SVG of horizontal bars from 0, a row for each name; "" of none.

    marks : of which y has a value for each name: dots, and bars of other styles."""
    values = [np.asarray(mark.y, float) for mark in marks]
    every = np.concatenate([*values, [0.0]])
    if not np.isfinite(every[:-1]).any():
        return ""
    thick = [mark for mark in marks if mark.style != "dots"]
    row = ROW + 8 * max(len(thick) - 1, 0)
    top = 30
    bottom = top + row * len(names)
    left = min(NAMED, 16 + LETTER * max(map(len, names)))
    x = axis(every, left, RIGHT - 4, False, 0.06)
    parts = [*legend(marks, label)] + [text(4, 14, label, "start")]
    ticks = x.ticks
    for tick, words in zip(ticks, tick_words(ticks), strict=True):
        at = float(x.at(tick))
        parts.append(f'<path class="grid" d="M{at:.1f} {top}V{bottom}"/>')
        parts.append(text(at, bottom + 18, words, "middle"))
    zero = float(x.at(0.0))
    for n, name in enumerate(names):
        middle = top + row * (n + 0.5)
        parts.append(text(left - 8, middle + 4, shortened(name, left - 12), "end"))
        for k, mark in enumerate(thick):
            value = float(mark.y[n])
            if math.isfinite(value):
                start, end = sorted((zero, float(x.at(value))))
                at = middle + 9 * (k - (len(thick) - 1) / 2) - 4
                parts.append(
                    f'<rect x="{start:.1f}" y="{at:.1f}" '
                    f'width="{max(end - start, 1):.1f}" height="8" {fill(mark)}/>'
                )
        for mark in marks:
            if mark.style == "dots" and math.isfinite(mark.y[n]):
                parts.append(dot(float(x.at(mark.y[n])), middle, mark))
    parts.append(f'<path class="axis" d="M{zero:.1f} {top}V{bottom}"/>')
    return svg(title, parts, bottom + 26)


def shortened(words: str, width: float) -> str:
    """Return words that fit a width, px."""
    most = int(width / LETTER)
    return (
        words if len(words) <= most else words[: most - 1] + "\N{HORIZONTAL ELLIPSIS}"
    )


def text(x: float, y: float, words: str, anchor: str, color: str = "") -> str:
    """Return words at a place. anchor : "start", "middle" or "end"."""
    paint = f' style="fill:{color}"' if color else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{paint}>'
        f"{escape(words)}</text>"
    )


def svg(title: str, parts: Sequence[str], height: float) -> str:
    """Return the picture, with its title below and for those who cannot see it."""
    words = escape(title)
    return (
        f'<figure><svg viewBox="0 0 {WIDTH} {height:.0f}" role="img">'
        f"<title>{words}</title>{''.join(parts)}</svg>"
        f'<figcaption aria-hidden="true">{words}</figcaption></figure>'
    )
