# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""translation.png: how near translated renders came to the camera's frames."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cg2raw.io.figure import BLUE, ORANGE, drawn
from studies.learners.translation_store import FOLDER

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MEASURES = {"chromaticities": BLUE, "colours": ORANGE}
PANEL, HEIGHT, COLUMNS = 3.2, 2.4, 3  # inches: width and height; panels in a row
Curves = Mapping[str, Any]  # panel: of each training, what its .json holds


def curves_in(folder: Path) -> dict[str, list[Any]]:
    """Return the Curves of a run: a panel for each camera and kind of scenes."""
    found: dict[str, list[Any]] = {}
    for path in sorted((folder / FOLDER).glob("*.json")):
        panel, _, _ = path.stem.rpartition("-")
        found.setdefault(panel, []).append(json.loads(path.read_text()))
    return found


def translation_curves(found: Curves) -> bytes:
    """Return the PNG of Curves: distances after each step, dotted where the camera's
    own training frames are."""
    columns = min(len(found), COLUMNS)
    rows = -(-len(found) // columns)

    def draw(figure: "Figure") -> None:
        panels = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
        for axes, (name, trainings) in zip(panels, found.items(), strict=False):
            draw_panel(axes, name, trainings)
        for axes in panels[len(found) :]:
            axes.set_visible(False)
        panels[0].set_ylabel("distance from captures")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)

    return drawn(HEIGHT * rows + 0.4, draw, PANEL * columns, colors=256)


def draw_panel(axes: "Axes", name: str, trainings: list[Any]) -> None:
    """Draw one panel: a line for each training and measure."""
    for number, training in enumerate(trainings):
        steps = [point["step"] for point in training["curve"]]
        for measure, color in MEASURES.items():
            values = [point[measure] for point in training["curve"]]
            label = measure if number == 0 else None
            axes.plot(steps, values, color=color, linewidth=1.2, label=label)
            axes.axhline(training["floor"][measure], color=color, linestyle=":")
    axes.set(title=name, xlabel="step", ylim=(0.0, None))
    axes.grid(True)
