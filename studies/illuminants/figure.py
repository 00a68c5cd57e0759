# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The figure of docs/illuminants.md: held-out neutrals and draws, camera by camera."""

import matplotlib
import numpy as np

from studies.illuminants.models import DRAWS, MODELS, UPI_GAINS, fitted_models, halves

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

SPLIT = 0
# Marker, colour and size of each model's draws; colours of Okabe and Ito.
STYLES = (("o", "#0072B2", 14), ("s", "#009E73", 9), ("x", "#D55E00", 16))


def write_figure(path, cameras):
    """Write the PNG of the first split. cameras : {name: (N, 2) neutrals}, nine."""
    figure, axes = pyplot.subplots(
        3, 3, figsize=(9, 9.4), sharex=True, sharey=True, layout="constrained"
    )
    for number, (camera, neutrals) in enumerate(cameras.items()):
        draw_camera(axes.flat[number], camera, neutrals, number)
    for axis in axes[-1]:
        axis.set_xlabel("R/G")
    for axis in axes[:, 0]:
        axis.set_ylabel("B/G")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    pyplot.close(figure)


def draw_camera(axis, camera, neutrals, number):
    """One panel: the held-out half, and the draws of each model."""
    fitted, held = halves(neutrals, number, SPLIT)
    axis.scatter(*neutrals[held].T, s=12, c="#bbbbbb", label="held-out neutrals")
    models = fitted_models(neutrals[fitted], camera, number)
    for model, name, style in zip(models, MODELS, STYLES, strict=True):
        marker, colour, size = style
        filled = {"facecolors": "none"} if marker != "x" else {}
        axis.scatter(
            *model.draws(DRAWS, SPLIT).T,
            s=size,
            marker=marker,
            linewidths=0.9,
            label=f"{DRAWS} draws, {name}",
            **({"edgecolors": colour, **filled} if filled else {"c": colour}),
        )
    gaussian, _, box = models
    outline(axis, gaussian.hull, STYLES[0][1])
    outline(axis, corners(1.0 / UPI_GAINS), STYLES[1][1])
    outline(axis, corners(np.array([box.low, box.high])), STYLES[2][1])
    axis.set_title(camera, fontsize=10)


def corners(ends):
    """(4, 2) corners of the rectangle between two points, in order."""
    (x0, y0), (x1, y1) = ends
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def outline(axis, polygon, colour):
    """Close a polygon with a thin line."""
    closed = np.vstack([polygon, polygon[:1]])
    axis.plot(*closed.T, color=colour, linewidth=0.6, alpha=0.7)
