# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""gap.png: how far each source is from the camera's own frames, study by study."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cg2raw.io.figure import drawn
from studies.figures.styles import styles
from studies.tables_paired import FLOOR, REAL, BySource
from studies.tasks.paired import Difference, difference

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

DEGREES = {  # studies of angular errors, as the figure calls them
    "illuminant": "illuminant",
    "light_draws": "illuminant, how lights are drawn",
}
UNITS = {  # of studies by night: the axis, the measure, and which way it is worse
    "isp": ("CIEDE2000 more than real", "difference", 1),
    "denoising": ("dB less than real", "psnr", -1),
    "photographs": ("dB less than real", "psnr", -1),
}
PANEL, LABELS = 2.6, 1.9  # inches: a panel's width, names of sources
BAR, AROUND = 0.17, 0.85  # inches: a bar with its gap, a panel's title and axis


@dataclass(frozen=True)
class Row:
    """What one row of panels shows; more is worse."""

    title: str
    unit: str
    cameras: dict[str, dict[str, Difference]]  # of each source from real


def rows_of(studies: Mapping[str, Mapping[str, Any]]) -> Iterator[Row]:
    """Yield the Rows of {study: {camera: entry}}, entries as results.json has them."""
    for name, found in studies.items():
        study = name.partition(", ")[0]
        if study in DEGREES:
            yield Row(
                DEGREES[study] + name.removeprefix(study),
                "degrees more than real",
                {camera: gaps(errors) for camera, errors in found.items()},
            )
        elif study in UNITS:
            unit, measure, sign = UNITS[study]
            for condition in next(iter(found.values())):
                values = {c: measured(e[condition], measure) for c, e in found.items()}
                yield Row(
                    f"{name}, {condition}",
                    unit,
                    {camera: gaps(errors, sign) for camera, errors in values.items()},
                )


def measured(entry: Mapping[str, Mapping[str, Any]], measure: str) -> BySource:
    """Return one measure of {source: {measure: of (draws, frames)}}."""
    return {source: measures[measure] for source, measures in entry.items()}


def gaps(values: BySource, sign: int = 1) -> dict[str, Difference]:
    """Return each source's Difference from real, which is left out.

    sign : -1 for a measure that is better if it is more."""
    return {
        source: difference(*(errors, values[REAL])[::sign])
        for source, errors in values.items()
        if source != REAL
    }


def gap_bars(studies: Mapping[str, Mapping[str, Any]]) -> bytes:
    """Return the PNG of {study: {camera: entry}}: a row a measure, a panel a camera."""
    rows = list(rows_of(studies))
    columns = max(len(row.cameras) for row in rows)
    heights = [AROUND + BAR * max(map(len, row.cameras.values())) for row in rows]

    def draw(figure: "Figure") -> None:
        parts = figure.subfigures(len(rows), 1, squeeze=False, height_ratios=heights)
        for row, part in zip(rows, parts[:, 0], strict=True):
            draw_row(part, row, columns)

    return drawn(sum(heights), draw, LABELS + PANEL * columns, colors=256)


def draw_row(part: "SubFigure", row: Row, columns: int) -> None:
    """Draw one row, all its panels to one scale."""
    from matplotlib.ticker import MaxNLocator

    part.suptitle(row.title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
    panels = part.subplots(1, columns, sharex=True, sharey=True, squeeze=False)[0]
    for axes in panels[len(row.cameras) :]:
        axes.set_axis_off()
    for axes, (camera, values) in zip(panels, row.cameras.items(), strict=False):
        draw_bars(axes, values)
        axes.set_title(camera, fontsize=9.5)
        axes.set_xlabel(row.unit)
    panels[0].xaxis.set_major_locator(MaxNLocator(4))
    panels[0].invert_yaxis()


def draw_bars(axes: "Axes", found: Mapping[str, Difference]) -> None:
    """Draw a bar for each source with its standard error, and the floor as a line."""
    color_of = {name: color for name, (color, _) in styles([REAL, *found]).items()}
    axes.barh(
        list(found),
        [gap.mean for gap in found.values()],
        xerr=[gap.error for gap in found.values()],
        color=[color_of[name] for name in found],
        alpha=0.75,
        error_kw={"elinewidth": 1.0, "capsize": 2.5, "ecolor": "#222222"},
    )
    axes.axvline(0.0, color="#444444", linewidth=0.8)
    if FLOOR in found:
        axes.axvline(found[FLOOR].mean, color="#444444", linewidth=0.8, linestyle=":")
    axes.grid(True, axis="x")
