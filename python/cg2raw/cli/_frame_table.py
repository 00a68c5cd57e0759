# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A table that says of frames what their files do not (calibrate --frames)."""

import math

from cg2raw.cli._uniform_frames import Kind, Said
from cg2raw.io.text_table import Row, read_table

COLUMNS = ("frame", "exposure_s", "temperature_c", "kind")
KINDS: dict[str, Kind | None] = {"": None, "dark": "dark", "flat": "flat"}


def read_frame_table(path: str) -> dict[str, Said]:
    """Return {frame: what is said of it} of a table with the columns frame, exposure_s,
    and perhaps temperature_c and kind; an empty cell says nothing.

    Raises ValueError naming file, line and value, OSError."""
    table = read_table(path)
    frame, exposure, temperature, kind = (table.column(name) for name in COLUMNS)
    for name, at in zip(COLUMNS[:2], (frame, exposure), strict=True):
        if at is None:
            table.fail(
                f"has no column {name}; the first row must name the columns "
                f"{', '.join(COLUMNS)}, the last two if they are known"
            )
    found: dict[str, Said] = {}
    for row in table.rows:
        word = row.text(kind).lower()
        if word not in KINDS:
            row.fail(kind, f'is "{word}"; must be dark, flat or empty')
        if row.text(frame) in found:
            row.fail(frame, f"{row.text(frame)} is there twice")
        found[row.text(frame)] = Said(
            exposure_time=number(row, exposure, 0, 1e6),
            temperature=number(row, temperature, -273.15, 200),
            kind=KINDS[word],
        )
    return found


def number(row: Row, column: int | None, low: float, high: float) -> float | None:
    """Return the number in a cell, None if it is empty. Raises ValueError."""
    value = row.number(column, low, high, missing=True)
    return None if math.isnan(value) else value
