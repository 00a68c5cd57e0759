# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""illuminant.png, light.png: errors of illuminants by the colour temperature of the
main light, as the paper's figure 5, and under LEDs."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from cg2raw.io.figure import drawn
from studies.figures.styles import styles
from studies.tables_illuminant import Errors
from studies.tasks.illuminant import LEDS
from studies.tasks.paired import Difference, difference, means

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ByLight = Mapping[str, Mapping[str, Errors]]  # lights: camera: errors
WIDTH, HEIGHT = 8.0, 4.2  # inches, of a camera's panel
APART = 0.05  # of the places of two sources, so that bars are told apart
HOLLOW = "no LEDs in training"


def errors_by_light(with_leds: ByLight, without: ByLight) -> bytes:
    """Return the PNG: a panel a camera, a line a source, with standard errors.

    with_leds, without : of training with LEDs among the lights and without, the latter
        hollow marks under LEDs alone."""
    cameras = list(dict.fromkeys(name for of in with_leds.values() for name in of))

    def draw(figure: "Figure") -> None:
        panels = figure.subplots(len(cameras), 1, sharey=True, squeeze=False)[:, 0]
        for axes, camera in zip(panels, cameras, strict=True):
            draw_camera(axes, camera, with_leds, without)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside right upper", frameon=False, handlelength=3.0
        )

    return drawn(HEIGHT * len(cameras), draw, WIDTH, colors=256)


def draw_camera(
    axes: "Axes", camera: str, with_leds: ByLight, without: ByLight
) -> None:
    """Draw one panel."""
    lights = [of for of in with_leds if camera in with_leds[of]]
    sources = list(with_leds[lights[0]][camera])
    held_out = without.get(LEDS, {}).get(camera, {})
    for number, (source, (color, dashes)) in enumerate(styles(sources).items()):
        found = [mean_of(with_leds[of][camera], source) for of in lights]
        places = np.arange(len(lights)) + APART * (number - len(sources) / 2)
        spectra = sum(of != LEDS for of in lights)
        for part in (slice(None, spectra), slice(spectra, None)):
            axes.errorbar(
                places[part],
                [error.mean for error in found[part]],
                [error.error for error in found[part]],
                color=color,
                ls=dashes,
                marker="o",
                markersize=4,
                linewidth=1.3,
                label=source if part.start is None else None,
            )
        if source in held_out:
            error = mean_of(held_out, source)
            axes.errorbar(
                places[-1] + 0.5,
                error.mean,
                error.error,
                color=color,
                marker="o",
                markersize=6,
                mfc="none",
            )
    labels = [*lights, *([HOLLOW] if held_out else [])]
    at = [*range(len(lights)), *([len(lights) - 0.5] if held_out else [])]
    axes.set_xticks(at, [label.replace(" K", "") for label in labels], rotation=20)
    axes.set(title=camera, xlabel="main light, K", ylabel="mean error, degrees")
    axes.set_ylim(bottom=0.0)
    axes.grid(True)


def mean_of(errors: Errors, source: str) -> Difference:
    """Return the mean of a source's errors, and its standard error over seeds and
    frames."""
    seeds, frames = means(errors[source])
    return difference(errors[source], np.zeros((len(seeds), len(frames))))
