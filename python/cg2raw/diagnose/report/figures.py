# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The figures of a report, with descriptions in words and numbers."""

from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.diagnosis import Curve, Diagnosis, Histogram
from cg2raw.diagnose.report import plots, sections
from cg2raw.diagnose.report import text as words
from cg2raw.diagnose.report.frame_images import Frame, Image, frames
from cg2raw.diagnose.report.sensor_figures import Panel, panels

MISSING = "report.html needs Jinja2 and Pillow: pip install 'cg2raw[diagnose]'"
SCALE_WORDS = (
    "Colour scale of the residual maps: blue is minus 4, white 0, red plus 4 standard "
    "deviations"
)


@dataclass(frozen=True)
class Figures:
    """The drawn figures; None where there is nothing to draw."""

    sensor: list[Panel]
    gap: Image
    residual_tests: Image | None
    histogram: Image | None
    scale: Image | None
    curves: list[Image]
    frames: list[Frame]

    def images(self) -> list[Image]:
        """Return all of them, each to be written beside the page."""
        single = [self.gap, self.residual_tests, self.histogram, self.scale]
        shown = [image for panel in self.sensor for image in panel.images]
        shown += [i for frame in self.frames for i in (*frame.images, *frame.maps)]
        return [image for image in (*single, *self.curves, *shown) if image is not None]


def draw(diagnosis: Diagnosis) -> Figures:
    """Return all figures of a diagnosis. Raises ValueError if Pillow is missing."""
    try:
        import PIL  # noqa: F401
    except ImportError:
        raise ValueError(MISSING) from None
    gap = figure("gap.png", plots.gap_figure(diagnosis.gap), gap_words(diagnosis))
    scale = figure("scale.png", plots.scale_figure(), SCALE_WORDS)
    curves = [
        figure(f"curve_{n:02}.png", plots.curve_figure(curve), curve_words(curve))
        for n, curve in enumerate(diagnosis.curves, 1)
    ]
    return Figures(
        sensor=list(panels(diagnosis.characteristics, figure)),
        gap=gap,
        residual_tests=tests_figure(diagnosis),
        histogram=histogram_figure(diagnosis),
        scale=scale if diagnosis.pictures else None,
        curves=curves,
        frames=frames(diagnosis.pictures),
    )


def tests_figure(diagnosis: Diagnosis) -> Image | None:
    """Return the bars of the residual tests, if there are any."""
    before, after = diagnosis.tests_before, diagnosis.tests_after
    if not (before or after):
        return None
    png = plots.tests_figure(before, after)
    return figure("residual_tests.png", png, tests_words(diagnosis))


def histogram_figure(diagnosis: Diagnosis) -> Image | None:
    """Return the histograms of the residuals, if there are any."""
    before, after = diagnosis.histogram_before, diagnosis.histogram_after
    if before is None and after is None:
        return None
    png = plots.histogram_figure(before, after)
    spreads = f"{spread('before', before)}, {spread('after', after)}"
    return figure(
        "histogram.png", png, f"Histogram of the residuals against N(0, 1): {spreads}"
    )


def figure(name: str, png: bytes, alt: str) -> Image:
    """Return a drawn figure as an image; its size stands in the PNG's header."""
    width, height = (int.from_bytes(png[at : at + 4], "big") for at in (16, 20))
    return Image(name, png, width, height, alt, "")


def gap_words(diagnosis: Diagnosis) -> str:
    """Return what the graphic of the gap shows."""
    rows = sections.gap_rows(diagnosis.gap)
    return "; ".join(
        f"{r['name']}: {r['before']} before, {r['after']} after" for r in rows
    )


def tests_words(diagnosis: Diagnosis) -> str:
    """Return what the bars of the residual tests show."""
    rows = sections.residual_tests(diagnosis)

    def significant(key: str) -> int:
        return sum(bool(row[key] and row[key]["significant"]) for row in rows)

    top = rows[0]
    sizes = [f"{top[k]['nats']} {k}" for k in ("before", "after") if top[k]]
    return (
        f"Bars of the residual tests in nats per pixel; the largest is {top['name']}: "
        f"{', '.join(sizes)}; {significant('before')} of {len(rows)} beyond chance "
        f"before, {significant('after')} after"
    )


def spread(label: str, histogram: Histogram | None) -> str:
    """Return the standard deviation of a histogram of z in words."""
    if not plots.is_drawable(histogram):
        return f"{label} unknown"
    edges, counts = (np.asarray(part, np.float64) for part in histogram)
    middles = (edges[1:] + edges[:-1]) / 2
    mean = np.average(middles, weights=counts)
    deviation = np.sqrt(np.average((middles - mean) ** 2, weights=counts))
    shown = words.number(mean), words.number(deviation)
    return f"{label} mean {shown[0]} and standard deviation {shown[1]}"


def curve_words(curve: Curve) -> str:
    """Return what a curve shows, with the numbers at its ends."""
    course = "no points"
    if len(curve.y):
        first, last = (
            f"{words.number(curve.y[end])} at {words.number(curve.x[end])}"
            for end in (0, -1)
        )
        course = f"from {first} to {last}"
    return (
        f"{curve.title}: {curve.y_label} against {curve.x_label}, {course}, with its "
        f"95 % interval and {words.counted(len(curve.measured_x), 'measured point')}"
    )
