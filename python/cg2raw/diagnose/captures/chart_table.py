# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A manifest's table of patch means becomes PatchMeans: in DN, with their colours."""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.diagnose.captures.chart import (
    COLORCHECKER,
    COLORCHECKER_NAMES,
    rec709_from_xyz,
    rec709_of,
    xyz_from_lab,
)
from cg2raw.diagnose.captures.manifest import FrameEntry
from cg2raw.diagnose.captures.manifest_charts import MOST_LAB, MOST_RADIANCE, Patch
from cg2raw.diagnose.captures.patch_means import (
    SITES,
    PatchMeans,
    read_columns,
    read_table,
    with_bounds,
)
from cg2raw.io.raw_checks import some
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.sensor import Sensor

LONE_COUNT = 1.0  # pixels of a mean that nobody counted: it has the noise of one
SPACES = {"rgb": ("r", "g", "b"), "xyz": ("X", "Y", "Z"), "lab": ("L", "a", "b")}

Levels = NDArray[np.float64]  # (4,), DN at the sites R, G1, G2 and B


@dataclass(frozen=True)
class TableFile(RawFile):
    """A table of patch means in the place of a RAW file; it has no pixels to read."""

    means: PatchMeans


def table_file(entry: FrameEntry, sensor: Sensor) -> TableFile:
    """Return a table of patch means. Raises ValueError at its line or the entry's."""
    try:
        means, notes = patch_means_of(entry, sensor)
    except OSError as error:
        entry.fail("file", f"cannot be used: {error}")
    header = RawHeader(
        entry.file, Area("patches", 0, 0, *means.mean.shape), notes=tuple(notes)
    )
    return TableFile(header, no_pixels, means)


def no_pixels(levels: object) -> RawImage:
    """Raise what reading a table's pixels would be: our own mistake."""
    raise AssertionError("a table of patch means has no pixels")


def patch_means_of(entry: FrameEntry, sensor: Sensor) -> tuple[PatchMeans, list[str]]:
    """Return (means in DN, notes). Raises ValueError at the entry's line, or at that
    of the table; OSError."""
    told = entry.means
    assert told is not None
    if sorted(sensor.cfa.upper()) != sorted("RGGB"):
        entry.fail(
            "file",
            f"is a table of R, G1, G2 and B, and the CFA of {sensor.id} is "
            f"{sensor.cfa}: give the frames themselves",
        )
    table = read_table(entry.file, told.unit)
    known = colors_of(entry)
    for name in table.names:
        if plain(name) not in known:
            field = "patches" if "patches" in entry.at else "chart"
            entry.fail(
                field,
                f'has no colour for "{name}" of {os.path.basename(entry.file)}; it has '
                f"{', '.join(known)}",
            )
    colors = np.array([known[plain(name)] for name in table.names]) * entry.gain
    mean, side, inferred = with_bounds(table, colors, told.cut)
    black, scale = levels_of(sensor, told.unit)
    missing = np.isnan(table.count)
    count = np.where(missing, told.count or LONE_COUNT, table.count)
    means = PatchMeans(
        names=table.names,
        colors=colors,
        mean=mean * scale + black,
        side=side,
        count=count,
        level_known=told.level_known,
    )
    notes = []
    if missing.any() and told.count is None:
        notes.append(
            "nobody says how many pixels a mean is of, so its noise is taken as that "
            "of one: add count, to the table or the frame"
        )
    absent = [name for name in known if name not in map(plain, table.names)]
    return means, notes + missing_notes(means, inferred, absent)


def levels_of(sensor: Sensor, unit: str) -> tuple[Levels, Levels]:
    """Return (offset, scale) at the sites R, G1, G2, B that make DN of a unit."""
    if unit == "DN":
        return np.zeros(len(SITES)), np.ones(len(SITES))
    levels = sensor.black_level
    black = np.array([levels[i % len(levels)] for i in places_of(sensor.cfa)], float)
    return black, sensor.white_level - black


def places_of(cfa: str) -> tuple[int, ...]:
    """Return where in a Bayer CFA's letters R, G1 (beside R), G2 and B are."""
    letters = cfa.upper()
    red, blue = letters.index("R"), letters.index("B")
    return red, red ^ 1, blue ^ 1, blue


def colors_of(entry: FrameEntry) -> dict[str, NDArray[np.float64]]:
    """Return scene-linear Rec.709 by the plain names of patches. Raises ValueError."""
    told = entry.means
    assert told is not None
    if not isinstance(told.colors, str):
        return {plain(patch.name): rec709_of(patch) for patch in told.colors}
    if told.colors.lower().endswith(".csv"):
        return read_colors(told.colors)
    rgb = rec709_from_xyz(xyz_from_lab(COLORCHECKER))
    return dict(zip(COLORCHECKER_NAMES, rgb, strict=True))


def read_colors(path: str) -> dict[str, NDArray[np.float64]]:
    """Return scene-linear Rec.709 of a .csv of colours: patch, and r g b (scene-linear
    Rec.709), X Y Z or L a b (D50). Raises ValueError, OSError."""
    columns = ("patch", *dict.fromkeys(n for names in SPACES.values() for n in names))
    table, at = read_columns(path, columns, required=("patch",))
    given = [space for space, names in SPACES.items() if None not in map(at.get, names)]
    if len(given) != 1:
        table.fail("columns must be patch and r, g, b or X, Y, Z or L, a, b")
    space = given[0]
    low, high = (-MOST_LAB, MOST_LAB) if space == "lab" else (-1.0, MOST_RADIANCE)
    found: dict[str, NDArray[np.float64]] = {}
    for row in table.rows:
        name = plain(row.text(at["patch"]))
        if name in found:
            row.fail(at["patch"], f'"{name}" is there twice')
        color = tuple(row.number(at[column], low, high) for column in SPACES[space])
        found[name] = rec709_of(Patch((0, 0, 0, 0), color, space, name))
    return found


def plain(name: str) -> str:
    """Return a patch's name as it is compared: "White 9.5 (.05 D)" is white, and a
    number of the ColorChecker is its patch."""
    words = re.sub(r"\(.*\)", "", name).lower().replace("_", " ").split()
    text = " ".join(words)
    text = {"white 9.5": "white", "black 2": "black"}.get(text, text)
    by_number = {str(n): name for n, name in enumerate(COLORCHECKER_NAMES, 1)}
    return by_number.get(text.lstrip("0"), text)


def missing_notes(
    means: PatchMeans, inferred: NDArray[np.bool_], absent: Sequence[str]
) -> list[str]:
    """Return sentences on what is missing, and how it counts."""
    unknown = np.isnan(means.mean)
    notes = []
    for where, words in (
        (inferred & (means.side < 0), "darker than all that were measured: they count "
         "as cut below those"),
        (inferred & (means.side > 0), "brighter than all that were measured: they "
         "count as cut above those"),
        (unknown, "and nothing says on which side they were cut: they do not count; "
         'add a column "cut" with low or high'),
    ):  # fmt: skip
        if where.any():
            notes.append(f"{patches(means, where)} are missing, {words}")
    if absent:
        notes.append(
            f"{some(absent)} are not in the table and do not count; patches that were "
            "cut need a row without numbers"
        )
    return notes


def patches(means: PatchMeans, where: NDArray[np.bool_]) -> str:
    """Return patches with their sites, such as "black (R, B)"."""
    words = [
        f"{means.names[patch]} ({', '.join(np.array(SITES)[where[patch]])})"
        for patch in np.flatnonzero(where.any(axis=1))
    ]
    return some(words)
