# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measured neutrals of grey cards, from a CSV file."""

import csv
import math

# Headers, in lower case without blanks, and what stands for R/G and B/G.
LAYOUTS = (("r", "g", "b"), ("r/g", "b/g"), ("rg", "bg"))
ALLOWED = "r,g,b or r/g,b/g or rg,bg"
LEAST, MOST = 0.01, 100.0  # R/G and B/G that a profile takes
FEWEST = 3  # distinct neutrals that span a distribution


def read_neutrals(path: str) -> list[list[float]]:
    """Return [[R/G, B/G], ...] of a CSV file of camera RGB of grey, black removed.

    The header names the columns: r,g,b of any scale, or r/g,b/g, or rg,bg; other
    columns are not read. Blank lines and what follows a # are skipped.
    Raises ValueError naming file, line and column; OSError if it cannot be read."""
    rows = rows_of(path)
    if not rows:
        raise ValueError(f"{path}: is empty; its header must be {ALLOWED}")
    (line, header), *rows = rows
    columns = columns_of(header, f"{path}, line {line}")
    neutrals = [neutral_of(row, columns, f"{path}, line {n}") for n, row in rows]
    distinct = len({tuple(neutral) for neutral in neutrals})
    if distinct < FEWEST:
        raise ValueError(
            f"{path}: holds {distinct} distinct neutrals; a distribution needs at "
            f"least {FEWEST}"
        )
    return neutrals


def rows_of(path: str) -> list[tuple[int, list[str]]]:
    """Return [(line number, [cell, ...]), ...] without comments and blank lines."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            lines = [line.partition("#")[0] for line in file]
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is no text; it must be CSV in UTF-8") from None
    return [
        (number, [cell.strip() for cell in next(csv.reader([line]))])
        for number, line in enumerate(lines, 1)
        if line.strip(" \t\r\n,")
    ]


def columns_of(header: list[str], place: str) -> dict[str, int]:
    """Return {name: index} of the one layout whose columns @header has."""
    names = ["".join(cell.lower().split()) for cell in header]
    found = [layout for layout in LAYOUTS if set(layout) <= set(names)]
    if len(found) != 1:
        have = "has columns of several" if found else "names no neutrals"
        raise ValueError(
            f"{place}: header {','.join(header)!r} {have}; it must hold {ALLOWED}, "
            "separated by commas"
        )
    for name in found[0]:
        if names.count(name) > 1:
            raise ValueError(f"{place}: column {name} is there twice")
    return {name: names.index(name) for name in found[0]}


def neutral_of(row: list[str], columns: dict[str, int], place: str) -> list[float]:
    """Return [R/G, B/G] of one row."""
    values = {name: number_of(row, at, name, place) for name, at in columns.items()}
    if len(values) == 3:
        neutral = {"r/g": values["r"] / values["g"], "b/g": values["b"] / values["g"]}
    else:
        neutral = values
    for name, ratio in neutral.items():
        if not LEAST <= ratio <= MOST:
            raise ValueError(
                f"{place}: {name} {ratio:g} must be {LEAST:g} to {MOST:g}; black must "
                "be removed from the measured values"
            )
    return [round(ratio, 6) for ratio in neutral.values()]


def number_of(row: list[str], index: int, name: str, place: str) -> float:
    """Return the positive number in one cell."""
    cell = row[index] if index < len(row) else ""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise ValueError(
            f"{place}, column {name}: {cell!r} must be a number above 0 with a "
            "decimal point"
        )
    return value
