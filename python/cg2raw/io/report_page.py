# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The page of a report: one screen of cards, then boxes, then what is folded.

One file of HTML, without network, scripts or other files."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass

MISSING = "the page needs Jinja2: pip install 'cg2raw[diagnose]'"


@dataclass(frozen=True)
class Card:
    """One result: what, how much, its interval, the evidence, and what shows it.

    charts : SVG. side : (label, number, bar of 0 to 100 % or None)."""

    title: str
    tag: str
    value: str
    interval: str
    evidence: str
    more: Sequence[str] = ()
    charts: Sequence[str] = ()
    side: Sequence[tuple[str, str, float | None]] = ()


@dataclass(frozen=True)
class Table:
    """Rows of words under a head. numbers : columns from which on all are numbers."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: int


@dataclass(frozen=True)
class Image:
    """A PNG of so many pixels, and what it shows, in words."""

    png: bytes
    width: int
    height: int
    alt: str

    @property
    def uri(self) -> str:
        """The address that holds it."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode("ascii")


@dataclass(frozen=True)
class Box:
    """What is listed: pairs of a name and a value, sentences, and a table. note : said
    beside the title. images : rows of pictures, each with a caption."""

    title: str
    note: str = ""
    pairs: Sequence[tuple[str, str]] = ()
    sentences: Sequence[str] = ()
    tables: Sequence[Table] = ()
    charts: Sequence[str] = ()
    images: Sequence[tuple[str, Sequence[Image]]] = ()

    @property
    def is_empty(self) -> bool:
        """Whether it holds nothing."""
        held = (self.pairs, self.sentences, self.tables, self.charts, self.images)
        return not any(held)


@dataclass(frozen=True)
class Page:
    """title : of the window. eyebrow : command, sensor, frames. badge : (word, tone),
    tone one of good, doubt, bad. numbers : (label, before, after), of which before may
    be "". warnings : above all. boxes : shown; folds : opened by a click."""

    title: str
    eyebrow: str
    badge: tuple[str, str]
    headline: str
    text: str
    numbers: Sequence[tuple[str, str, str]] = ()
    warnings: Sequence[str] = ()
    cards: Sequence[Card] = ()
    boxes: Sequence[Box] = ()
    folds: Sequence[Box] = ()
    footer: str = ""


def html_of(page: Page) -> str:
    """Return the HTML. Raises ValueError if Jinja2 is missing."""
    try:
        import jinja2
    except ImportError:
        raise ValueError(MISSING) from None
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("cg2raw.io"),
        autoescape=True,  # names of frames are anybody's
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("report.html.jinja").render(page=page)
