# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What captures.yaml says of charts: patches in a frame, or a table of their means."""

import os
from dataclasses import dataclass

from cg2raw.diagnose.captures.patch_means import LARGEST, MOST_COUNT
from cg2raw.diagnose.captures.yaml_lines import Value, existing

IN_FRAMES = ("patches", "chart", "corners")
IN_TABLES = ("patches", "chart", "unit", "count", "cut_below", "cut_above")
OF_CHARTS = tuple(dict.fromkeys(IN_FRAMES + IN_TABLES))
NOT_IN_TABLES = ("corners", "mask")
COLORS = ("rgb", "xyz", "lab")
NAMED_CHART = "colorchecker"
MOST_RADIANCE, MOST_PIXEL, MOST_LAB = 1e6, 65535.0, 200.0
NO_AREA = (0, 0, 0, 0)
UNITS = tuple(LARGEST)


@dataclass(frozen=True)
class Patch:
    """A patch of one colour.

    area : row, column, height, width, px of the active area; NO_AREA in a table, where
        patches have names.
    color : three numbers in space: "rgb" scene-linear Rec.709; "xyz" (Y of a perfect
        diffuser is 1) and "lab" under D50, as charts are published."""

    area: tuple[int, int, int, int]
    color: tuple[float, ...]
    space: str
    name: str = ""


@dataclass(frozen=True)
class MeansEntry:
    """How a table of patch means is to be read.

    colors : its patches by name, or "colorchecker", or the path of a table of colours.
    unit : of the means. count : pixels of a mean where the table does not say; None if
    the manifest does not either. cut : below and above what patches were left out, in
    that unit; None if not said. level_known : a gain says how bright the chart was."""

    colors: tuple[Patch, ...] | str
    unit: str
    count: float | None
    cut: tuple[float | None, float | None]
    level_known: bool


def is_table(path: str) -> bool:
    """Return whether a file is a table of patch means, by its name."""
    return path.lower().endswith(".csv")


def check_chart(value: Value, own: dict[str, Value], table: bool) -> None:
    """Raise ValueError unless a chart is given in one of the ways that there are."""
    others = NOT_IN_TABLES if table else tuple(set(IN_TABLES) - set(IN_FRAMES))
    for name in others:
        if name in own:
            where = "patch means" if table else "a chart in a frame"
            own[name].fail(f"is not for {where}; remove it")
    given = [name for name in IN_FRAMES if name in own]
    words = " and ".join(given) or "neither patches nor chart"
    if table and len(given) != 1:
        value.fail(
            f"has {words}; patch means need one of them: patches by name, or chart: "
            "colorchecker or a .csv of colours"
        )
    if not table and given not in (["patches"], ["chart", "corners"]):
        value.fail(
            f"has {words}; a chart needs patches, or chart: colorchecker with its "
            "corners"
        )
    if "chart" in own and not table:
        own["chart"].word((NAMED_CHART,))


def means_entry(own: dict[str, Value], manifest: str | os.PathLike[str]) -> MeansEntry:
    """Return what a frame says of its table of means. Raises ValueError."""
    unit = own["unit"].word(UNITS) if "unit" in own else UNITS[0]

    def bound(name: str) -> float | None:
        most = LARGEST[unit]
        return own[name].number(-most, most, unit) if name in own else None

    colors: tuple[Patch, ...] | str
    if "patches" in own:
        colors = named_patches(own["patches"])
    elif is_table(own["chart"].text()):
        colors = existing(own["chart"], manifest)
    else:
        colors = own["chart"].word((NAMED_CHART,))
    count = own["count"].number(1.0, MOST_COUNT, "pixels") if "count" in own else None
    cut = bound("cut_below"), bound("cut_above")
    return MeansEntry(colors, unit, count, cut, level_known="gain" in own)


def patches_of(value: Value) -> tuple[Patch, ...]:
    """Return the patches of a chart. Raises ValueError, also if two overlap."""
    patches: list[Patch] = []
    for item in value.items():
        own = item.fields(("area", *COLORS), required=("area",))
        numbers = own["area"].numbers(4, 0.0, MOST_PIXEL)
        if any(number != int(number) for number in numbers) or min(numbers[2:]) < 4:
            own["area"].fail(
                "must be [row, column, height, width] in whole pixels, at least 4 high "
                "and wide"
            )
        row, col, height, width = (int(number) for number in numbers)
        for index, other in enumerate(patches):
            r, c, h, w = other.area
            if row < r + h and r < row + height and col < c + w and c < col + width:
                own["area"].fail(f"overlaps that of patches[{index}]; move one")
        patches.append(Patch((row, col, height, width), *color_of(item, own)))
    if not patches:
        value.fail("has no patch; add at least one")
    return tuple(patches)


def named_patches(value: Value) -> tuple[Patch, ...]:
    """Return patches by name. Raises ValueError, also if two have one name."""
    patches: dict[str, Patch] = {}
    for item in value.items():
        own = item.fields(("patch", *COLORS), required=("patch",))
        name = own["patch"].text()
        if name in patches:
            own["patch"].fail(f'"{name}" is there twice; give each patch one name')
        patches[name] = Patch(NO_AREA, *color_of(item, own), name)
    if not patches:
        value.fail("has no patch; add at least one")
    return tuple(patches.values())


def color_of(item: Value, own: dict[str, Value]) -> tuple[tuple[float, ...], str]:
    """Return (colour, its space) of a patch. Raises ValueError."""
    spaces = [name for name in COLORS if name in own]
    if len(spaces) != 1:
        item.fail(f"has {' and '.join(spaces) or 'no colour'}; needs one of rgb, "
                  "xyz and lab")  # fmt: skip
    space = spaces[0]
    low, high = (-MOST_LAB, MOST_LAB) if space == "lab" else (-1.0, MOST_RADIANCE)
    return own[space].numbers(3, low, high), space


def corners_of(value: Value) -> tuple[tuple[float, ...], ...]:
    """Return four (row, col)."""
    corners = value.items()
    if len(corners) != 4:
        value.fail(
            f"has {len(corners)} positions; must have 4: the centres of the patches "
            "dark skin, bluish green, black and white, each [row, column]"
        )
    return tuple(corner.numbers(2, 0.0, MOST_PIXEL) for corner in corners)
