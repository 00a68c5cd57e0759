# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Figures of the report; the same diagnosis gives the same bytes.

Drawn as wide as a telephone shows them, so that their words stay legible there."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np

from cg2raw.diagnose.diagnosis import Curve, Gap, Histogram, ResidualTest
from cg2raw.diagnose.report.frame_images import COLOR_STEPS, SIGMAS
from cg2raw.diagnose.report.text import NOT_KNOWN, is_known, number, plain, power_of_ten
from cg2raw.io.figure import drawn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import XAxis, YAxis
    from matplotlib.figure import Figure

# Distinct for all common colour vision. Source: Okabe and Ito, Color Universal
# Design, 2008.
BEFORE, AFTER, MEASURED_COLOR, FITTED = "#d55e00", "#0072b2", "#333333", "#009e73"
LEAST_DRAWN = 1e-6  # per pixel; nothing smaller is drawn at its place
SIGNIFICANT = 0.001  # p-value, divided by the number of tests
MOST_TESTS = 14  # bars; the table has them all
LEAST_DENSITY = 1e-6
LONGEST = 32  # characters of a label

Interval = tuple[float, float] | None
Pair = tuple[str, ResidualTest | None, ResidualTest | None]  # name, before, after


def gap_figure(gap: Gap) -> bytes:
    """Return the arrows from before to after: nats per pixel, chi-square, repeats."""
    intervals = gap.interval_before, gap.interval_after
    none = None, None
    rows: list[tuple[Any, ...]] = [
        ("gap, nats/pixel", gap.before, gap.after, None, intervals, 2),
        ("reduced chi-square", gap.chi2_before, gap.chi2_after, 1.0, none, 4),
    ]
    repeats = gap.systematic_before, gap.systematic_after
    if repeats != none:
        rows.append(("systematic error, noise variances", *repeats, None, none, 2))

    def draw(figure: "Figure") -> None:
        for axes, row in zip(
            np.ravel(figure.subplots(len(rows), 1)), rows, strict=True
        ):
            draw_step(axes, *row)

    return drawn(0.2 + 1.0 * len(rows), draw)


def set_log(axis: "XAxis | YAxis") -> None:
    """Make an axis logarithmic, with powers of ten and no smaller ticks."""
    from matplotlib.ticker import FuncFormatter, NullLocator

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.set_major_formatter(FuncFormatter(lambda x, _: power(x)))
    axis.set_minor_locator(NullLocator())


def power(value: float) -> str:
    """Return a tick of a logarithmic axis; few are small enough to be written out."""
    exponent = round(float(np.log10(value)))
    return f"{value:g}" if 0 <= exponent <= 2 else power_of_ten(exponent)


def draw_step(
    axes: "Axes",
    label: str,
    before: float | None,
    after: float | None,
    ideal: float | None,
    intervals: tuple[Interval, Interval],
    digits: int,
) -> None:
    """Draw one quantity's way from before to after on a logarithmic axis."""
    bounds = [x for pair in intervals if pair for x in pair]
    floor, top = span([before, after, *bounds], ideal)
    set_log(axes.xaxis)
    axes.set(xlim=(floor, top), ylim=(-1.6, 1.2), yticks=[])
    axes.spines["left"].set_visible(False)
    axes.grid(axis="x")
    axes.set_title(label, loc="left", fontsize=9.5, color="#222222")
    if ideal is not None:
        axes.axvline(ideal, color="#777777", linewidth=1.2, linestyle=":")
    if not (is_known(before) or is_known(after)):
        axes.text(
            0.5, 0.5, NOT_KNOWN, transform=axes.transAxes, ha="center", va="center"
        )
        return
    if is_known(before) and is_known(after):
        axes.annotate(
            "", (max(after, floor * 1.15), 0), (max(before, floor * 1.15), 0),
            arrowprops={"arrowstyle": "-|>", "color": "#555555", "linewidth": 1.6,
                        "shrinkA": 6, "shrinkB": 7},
        )  # fmt: skip
    for value, color, pair, shift in zip(
        (before, after), (BEFORE, AFTER), intervals, (8, -17), strict=True
    ):
        if is_known(value):
            draw_value(axes, value, number(value, digits), color, pair, floor, shift)


def span(values: Sequence[float | None], ideal: float | None) -> tuple[float, float]:
    """Return the ends of a logarithmic axis; room for what is not above zero."""
    known = [x for x in values if is_known(x)]
    positive = [max(x, LEAST_DRAWN) for x in known if x > 0]
    shown = positive + ([] if ideal is None else [ideal])
    least, most = min(shown, default=0.1), max(shown, default=0.1)
    room = 2 if len(positive) == len(known) else 100
    return least / room, max(most, least * 10) * 2.5


def draw_value(
    axes: "Axes",
    value: float,
    shown: str,
    color: str,
    interval: Interval,
    floor: float,
    shift: float,
) -> None:
    """Draw a value and its interval; what lies below the axis is an arrowhead."""
    at = max(value, floor * 1.15)
    if interval and all(is_known(bound) for bound in interval):
        axes.plot(np.maximum(interval, floor), (0, 0), color=color, linewidth=4,
                  alpha=0.35, solid_capstyle="butt", zorder=1)  # fmt: skip
    axes.plot(at, 0, "<" if value < floor else "o", color=color, markersize=9)
    axes.annotate(shown, (at, 0), (0, shift), textcoords="offset points",
                  ha="left" if value < floor else "center", color=color,
                  fontweight="bold")  # fmt: skip


def tests_figure(
    before: Sequence[ResidualTest], after: Sequence[ResidualTest]
) -> bytes:
    """Return the bars of the residual tests, largest first; pale: within chance."""
    pairs = paired(before, after)[:MOST_TESTS]
    count = max(len(before), len(after), 1)

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for row, (_, *tests) in enumerate(pairs):
            for test, color, shift in zip(
                tests, (BEFORE, AFTER), (-0.2, 0.2), strict=True
            ):
                draw_bar(axes, row + shift, test, color, count)
        set_log(axes.xaxis)
        axes.set_xlim(LEAST_DRAWN, 2 * largest(pairs))
        axes.set_yticks(range(len(pairs)), [short(name) for name, *_ in pairs])
        axes.set_ylim(len(pairs) - 0.4, -0.6)
        axes.set_xlabel("nats/pixel")
        axes.grid(axis="x")
        axes.tick_params(axis="y", length=0)
        legend(figure, (("before", BEFORE), ("after", AFTER)))

    return drawn(0.9 + 0.28 * max(len(pairs), 1), draw)


def draw_bar(
    axes: "Axes", at: float, test: ResidualTest | None, color: str, count: int
) -> None:
    """Draw one test's bar; none if there is no such test or its size is not known."""
    if test is None or not is_known(test.nats_per_pixel):
        return
    is_chance = not is_known(test.p_value) or test.p_value >= SIGNIFICANT / count
    axes.barh(at, max(test.nats_per_pixel - LEAST_DRAWN, 0), 0.36, left=LEAST_DRAWN,
              color=color, alpha=0.3 if is_chance else 1)  # fmt: skip


def largest(pairs: Sequence[Pair]) -> float:
    """Return the largest size of any test, nats per pixel."""
    sizes = [t.nats_per_pixel for _, *tests in pairs for t in tests if t is not None]
    return (
        max([size for size in sizes if is_known(size)], default=1.0) + LEAST_DRAWN * 10
    )


def paired(before: Sequence[ResidualTest], after: Sequence[ResidualTest]) -> list[Pair]:
    """Return [(name, test before or None, test after or None)], largest first."""
    first = {test.name: test for test in before}
    last = {test.name: test for test in after}
    rows = [(n, first.get(n), last.get(n)) for n in {**first, **last}]

    def size(row: Pair) -> float:
        sizes = [test.nats_per_pixel for test in row[1:] if test is not None]
        return max((x for x in sizes if is_known(x)), default=-1.0)

    return sorted(rows, key=size, reverse=True)


def histogram_figure(before: Histogram | None, after: Histogram | None) -> bytes:
    """Return the densities of z, each (edges, counts) or None, against N(0, 1)."""

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        z = np.linspace(-8, 8, 321)
        normal = np.exp(-z * z / 2) / np.sqrt(2 * np.pi)
        axes.fill_between(z, LEAST_DENSITY, np.maximum(normal, LEAST_DENSITY),
                          color="#cccccc", linewidth=0)  # fmt: skip
        for histogram, color in ((before, BEFORE), (after, AFTER)):
            if not is_drawable(histogram):
                continue
            edges, counts = (np.asarray(part, np.float64) for part in histogram)
            density = counts / np.diff(edges) / counts.sum()
            axes.stairs(np.maximum(density, LEAST_DENSITY), edges, color=color,
                        linewidth=1.6, baseline=LEAST_DENSITY)  # fmt: skip
        axes.set(xlim=(-8, 8), xticks=(-8, -4, 0, 4, 8))
        set_log(axes.yaxis)
        axes.set_ylim(LEAST_DENSITY, 2)
        axes.set_xlabel("residual z, standard deviations")
        axes.set_ylabel("density")
        axes.grid()
        legend(figure, (("before", BEFORE), ("after", AFTER), ("N(0, 1)", "#cccccc")))

    return drawn(3.1, draw)


def is_drawable(histogram: Histogram | None) -> TypeGuard[Histogram]:
    """Whether a histogram is there, and counts anything."""
    if histogram is None or not np.isfinite(np.concatenate(histogram)).all():
        return False
    return bool(np.sum(histogram[1]) > 0)


def curve_figure(curve: Curve) -> bytes:
    """Return a fitted curve with its band, and the measured points."""

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        axes.fill_between(curve.x, curve.low, curve.high, color=FITTED, alpha=0.25,
                          linewidth=0, label="95 %")  # fmt: skip
        axes.plot(curve.x, curve.y, color=FITTED, linewidth=2, label="fitted")
        axes.plot(curve.measured_x, curve.measured_y, "o", color=MEASURED_COLOR,
                  markersize=3.5, alpha=0.8, label="measured")  # fmt: skip
        axes.set(xlabel=short(curve.x_label), ylabel=short(curve.y_label))
        axes.grid()
        axes.margins(0.03)
        words = (("fitted", FITTED), ("95 % interval", "#bfe6dc"))
        legend(figure, (*words, ("measured", MEASURED_COLOR)))

    return drawn(3.1, draw)


def scale_figure() -> bytes:
    """Return the colour bar of the residual maps."""

    def draw(figure: "Figure") -> None:
        from matplotlib import colormaps
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        figure.colorbar(
            ScalarMappable(
                Normalize(-SIGMAS, SIGMAS), colormaps["RdBu_r"].resampled(COLOR_STEPS)
            ),
            cax=figure.subplots(),
            orientation="horizontal",
            extend="both",
            ticks=[-4, -2, 0, 2, 4],
            label="measured \N{MINUS SIGN} simulated, standard deviations",
        )

    return drawn(0.7, draw, 3.2)


def short(label: str) -> str:
    """Return a label that leaves room for what it labels."""
    label = " ".join(plain(label).split())
    return label if len(label) <= LONGEST else label[: LONGEST - 3] + "..."


def legend(figure: "Figure", entries: Sequence[tuple[str, str]]) -> None:
    """Draw the key above the axes, where it covers nothing."""
    from matplotlib.patches import Patch

    figure.legend(
        handles=[Patch(color=color, label=label) for label, color in entries],
        loc="outside upper left",
        ncols=len(entries),
        frameon=False,
        fontsize=9.5,
        handlelength=1,
        columnspacing=1.4,
    )
