# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Patch means: a chart as a table of what each patch measured, without a mosaic.

A patch that is missing because it was too dark or too bright is evidence: without it,
what is left is brighter, or darker, than its colours say. Where the side is known, the
patch counts as censored: all that is known of its mean is which side of a bound it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.io import text_table

SITES = ("R", "G1", "G2", "B")  # G1: green in rows of red, G2: in rows of blue
COLOR_OF_SITE = [0, 1, 1, 2]
DEVIATIONS = tuple(f"{site}_sd" for site in SITES)
COLUMNS = ("patch", *SITES, *DEVIATIONS, "count", "cut")
SIDES = {"low": -1, "high": 1}
MOST_DN, MOST_SIGNAL, MOST_COUNT = 65535.0, 2.0, 1e9
LARGEST = {"DN": MOST_DN, "signal": MOST_SIGNAL}  # of a mean, by its unit


@dataclass(frozen=True)
class PatchMeans:
    """Means of P patches at the four sites of a Bayer CFA, in the order of SITES.

    names : of the patches. colors : (P, 3) scene-linear Rec.709; 1 is the white level
    if level is known.
    mean : (P, 4) DN; the bound where side is not 0; NaN where nothing is known.
    side : (P, 4) int, -1 where the mean is known to lie below its bound, 1 above.
    count : (P,) pixels of one site that a mean is of.
    level_known : whether the manifest says how bright the chart was."""

    names: tuple[str, ...]
    colors: NDArray[np.float64]
    mean: NDArray[np.float64]
    side: NDArray[np.int64]
    count: NDArray[np.float64]
    level_known: bool

    @property
    def measured(self) -> NDArray[np.bool_]:
        """(P, 4), where there is a mean."""
        there: NDArray[np.bool_] = np.isfinite(self.mean) & (self.side == 0)
        return there

    def part(self, index: int, parts: int) -> "PatchMeans":
        """Return every parts-th patch from one on."""
        ours = np.s_[index::parts]
        return replace(
            self,
            names=self.names[ours],
            colors=self.colors[ours],
            mean=self.mean[ours],
            side=self.side[ours],
            count=self.count[ours],
        )


@dataclass(frozen=True)
class Table:
    """What a file of patch means says. cut : "low", "high" or "" of each patch."""

    names: tuple[str, ...]
    mean: NDArray[np.float64]
    count: NDArray[np.float64]
    cut: tuple[str, ...]


def read_table(path: str, unit: str = "DN") -> Table:
    """Return a table of patch means; empty and NaN are missing, and NaN in the Table.

    unit : "DN", or "signal", 0 to 1 above black.
    Raises ValueError naming file, line, column, value and bound, OSError."""
    table, at = read_columns(path, COLUMNS, required=("patch", *SITES))
    seen: dict[str, int] = {}
    for row in table.rows:
        name = row.text(at["patch"])
        if not name or name in seen:
            what = f"is there twice, first in line {seen[name]}" if name else "is empty"
            row.fail(at["patch"], f'"{name}" {what}; give each patch one name')
        seen[name] = row.line

    def numbers(names: Sequence[str], low: float, high: float) -> NDArray[np.float64]:
        return np.array(
            [
                [row.number(at[name], low, high, missing=True) for name in names]
                for row in table.rows
            ]
        )

    least = 0.0 if unit == "DN" else -MOST_SIGNAL
    cut = tuple(row.text(at["cut"]).lower() for row in table.rows)
    for row, word in zip(table.rows, cut, strict=True):
        if word and word not in SIDES:
            row.fail(at["cut"], f'is "{word}"; must be low, high or empty')
    numbers(DEVIATIONS, 0.0, LARGEST[unit])  # checked, and not needed
    return Table(
        names=tuple(seen),
        mean=numbers(SITES, least, LARGEST[unit]),
        count=numbers(("count",), 1.0, MOST_COUNT)[:, 0],
        cut=cut,
    )


def read_columns(
    path: str, columns: Sequence[str], required: Sequence[str]
) -> tuple[text_table.Table, dict[str, int | None]]:
    """Return (table, {column: where it is}) of a file. Raises ValueError, OSError."""
    table = text_table.read_table(path)
    allowed = ", ".join(columns)
    known = [text_table.folded(name) for name in columns]
    for name in table.names:
        if text_table.folded(name) not in known:
            table.fail(f"column {name} is unknown; columns are {allowed}")
    at = {name: table.column(text_table.folded(name)) for name in columns}
    for name in required:
        if at[name] is None:
            table.fail(f"column {name} is missing; columns are {allowed}")
    if not table.rows:
        raise ValueError(f"{path}: has no patch; add at least one row")
    return table, at


def with_bounds(
    table: Table,
    colors: NDArray[np.float64],
    known: tuple[float | None, float | None],
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]]:
    """Return (mean with bounds, side, where the side was inferred), each (P, 4).

    colors : (P, 3). known : DN below and above which patches were cut, if said.

    The column "cut" says the side; else a patch that is darker, in this colour, than
    all that were measured lies below them, and a brighter one above: so where a
    threshold was one for all. Their lowest or highest mean is the bound where none is
    known: what a threshold left out lies beyond it."""
    there = np.isfinite(table.mean)
    side = np.array([[SIDES.get(word, 0)] * len(SITES) for word in table.cut])
    shade = colors[:, COLOR_OF_SITE]
    dark = shade < np.where(there, shade, np.inf).min(axis=0)
    bright = shade > np.where(there, shade, -np.inf).max(axis=0)
    guess = np.where(dark == bright, 0, np.where(dark, -1, 1))  # both: none is there
    inferred = ~there & (side == 0) & (guess != 0)
    side = np.where(there, 0, np.where(side == 0, guess, side))
    lowest = np.where(there, table.mean, np.inf).min(axis=0)
    highest = np.where(there, table.mean, -np.inf).max(axis=0)
    low = lowest if known[0] is None else np.full(len(SITES), known[0])
    high = highest if known[1] is None else np.full(len(SITES), known[1])
    bound = np.where(side < 0, low, high)
    side = np.where(np.isfinite(bound), side, 0)
    return np.where(side == 0, table.mean, bound), side, inferred & (side != 0)
