# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors as a table: for a terminal, in which words stay whole, and for a pipe."""

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from cg2raw.cfa import is_mono
from cg2raw.near_words import bare
from cg2raw.profile.summary import cfa_word, iso_words, kelvin_words

if TYPE_CHECKING:
    from rich.table import Table

Summary = Mapping[str, Any]  # as summary() makes it

HEAD = (
    "id", "camera", "size", "CFA", "bits", "illuminants", "ISO", "matrices", "sources",
)  # fmt: skip
# What a narrow terminal loses, in this order; the id it keeps.
LEAST_NEEDED = ("sources", "bits", "matrices", "CFA", "size", "ISO", "illuminants")
ONE_LINE = ("id", "size", "CFA", "bits")  # columns that are never wrapped
WORD = re.compile(r"\S+(?: K\b)?")  # what stays on one line
GAP = 2  # columns between two
LEAST_SOURCES = 30  # columns; in fewer, they only lengthen the table


def matching(found: Sequence[dict[str, Any]], word: str) -> list[dict[str, Any]]:
    """Return the summaries whose id, make or model has @word in it.

    Case, hyphens and spaces do not count; a word without a letter or digit is in
    none."""
    asked = bare(word)
    return [
        sensor
        for sensor in found
        if asked
        and any(asked in bare(text) for text in (sensor["id"], full_name(sensor)))
    ]


def full_name(sensor: Summary) -> str:
    """Return make and model."""
    return f"{sensor['make']} {sensor['model']}"


def plain_table(found: Sequence[Summary]) -> list[str]:
    """Return the lines of the table for a pipe: one each, nothing is left out."""
    rows = [HEAD, *map(row_of, found)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    return [
        (" " * GAP)
        .join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        .rstrip()
        for row in rows
    ]


def rich_table(found: Sequence[Summary], columns: int) -> "Table":
    """Return the table for a terminal of so many columns.

    Cells are wrapped between words alone; what has no room is left out."""
    from rich import box
    from rich.table import Table

    rows = [row_of(sensor) for sensor in found]
    widths = widths_of(rows, columns)
    table = Table(
        box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0)
    )
    for name, width in widths.items():
        table.add_column(name, width=width, no_wrap=name in ONE_LINE)
    shown = [HEAD.index(name) for name in widths]
    for row in rows:
        table.add_row(*(row[i] for i in shown))
    return table


def widths_of(rows: Sequence[Sequence[str]], columns: int) -> dict[str, int]:
    """Return {name: width} of the columns that have room, in their order.

    Each is at least as wide as its longest word; what room is left goes to the columns
    from left to right, the sources last."""
    least, most = {}, {}
    for name, *cells in zip(HEAD, *rows, strict=True):
        words = [name, *cells]
        most[name] = max(map(len, words))
        if name not in ONE_LINE:
            words = WORD.findall(" ".join(words))
        least[name] = max(map(len, words))
    least["sources"] = max(least["sources"], min(LEAST_SOURCES, most["sources"]))
    for name in LEAST_NEEDED:
        if total(least) > columns:
            del least[name]
    room = columns - total(least)
    for name in least:
        more = max(0, min(room, most[name] - least[name]))
        least[name] += more
        room -= more
    return least


def total(widths: Mapping[str, int]) -> int:
    """Return the columns of a table."""
    return sum(widths.values()) + GAP * (len(widths) - 1)


def row_of(sensor: Summary) -> tuple[str, ...]:
    """Return the cells of one summary."""
    return (
        sensor["id"],
        sensor["camera"],
        f"{sensor['width']}x{sensor['height']}",
        cfa_word(sensor["cfa"]),
        str(sensor["bits"]),
        light_words(sensor),
        iso_words(sensor["noise"]),
        ", ".join(c["light_source"] for c in sensor["calibrations"]),
        short_sources(sensor["sources"]),
    )


def light_words(sensor: Summary) -> str:
    """Return the range of the illuminants that sample:n draws; "black bodies" where it
    draws these between the calibration illuminants, "any" of a monochrome sensor."""
    if is_mono(sensor["cfa"]):
        return "any"
    cct = sensor["illuminants"]["cct"]
    if not cct and len(sensor["calibrations"]) == 2:
        return "black bodies"
    return kelvin_words(cct)


def short_sources(sources: Mapping[str, str]) -> str:
    """Return in a few words where colour, illuminants and noise are from: what leads
    each source."""
    keys = ("color_matrix_1", "color_matrix", "illuminants", "noise")
    texts = [sources[key] for key in keys if key in sources]
    heads = [re.split(r"[:;,(]", text)[0].strip() for text in texts]
    return "; ".join(dict.fromkeys(filter(None, heads)))
