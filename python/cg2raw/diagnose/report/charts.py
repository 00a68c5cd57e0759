# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The charts of a diagnosis as SVG: measured, before and after."""

from collections.abc import Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import Chart, Curve, Diagnosis, Finding, Histogram
from cg2raw.diagnose.effects.catalogue import title as words_of
from cg2raw.diagnose.report.values import scale_of
from cg2raw.io.svg import AFTER, BEFORE, INK, SHAPES, SITES, Mark, bars, lines

WITHOUT, WITH = "without it", "with it"
MOST_VALUES = 6  # that are drawn of an effect without another chart
OF_PROFILE, FOUND = "profile", "with what was found"


def charts_of(finding: Finding, diagnosis: Diagnosis) -> list[str]:
    """Return what shows one effect: its own charts, or the intervals of its values."""
    own = [svg_of(one) for one in diagnosis.charts if one.effect == finding.name]
    own += [curve(one) for one in diagnosis.curves if one.effect == finding.name]
    own = [one for one in own if one]
    return own[:1] or [one for one in [intervals(finding, diagnosis)] if one]


def svg_of(chart: Chart) -> str:
    """Return a chart of darks and flats."""
    names = (WITHOUT, WITH) if chart.effect else (OF_PROFILE, FOUND)
    title = chart.title
    if chart.form == "bars":
        (one,) = chart.series
        marks = [
            Mark(names[0], one.x, one.before, "dashed", BEFORE),
            Mark(names[1], one.x, one.after, "solid", AFTER),
            Mark("measured", one.x, one.measured, "dots"),
        ]
        return bars(title, chart.names, marks, chart.y_label)
    marks, is_alone, none = [], len(chart.series) == 1, np.zeros(0)
    if not is_alone:
        marks += [
            Mark(names[0], none, none, "dashed"),
            Mark(names[1], none, none, "solid"),
        ]
    for n, one in enumerate(chart.series):
        colors = (BEFORE, AFTER, INK) if is_alone else 3 * (SITES.get(one.name, INK),)
        labels = (*names, "measured") if is_alone else ("", "", one.name)
        styles = ("band", "band") if chart.form == "bands" else ("dashed", "solid")
        marks += [
            Mark(labels[0], one.x, one.before, styles[0], colors[0]),
            Mark(labels[1], one.x, one.after, styles[1], colors[1]),
            Mark(labels[2], one.x, one.measured, "dots", colors[2], SHAPES[n % 4]),
        ]
    return lines(title, marks, (chart.x_label, chart.y_label), chart.scale)


def curve(found: Curve) -> str:
    """Return a curve of images; without the effect it is 1."""
    ends = np.array([found.x.min(), found.x.max()]) if len(found.x) else found.x
    flat = found.effect and "," not in found.effect and found.y_label != "variance"
    marks = [
        Mark(WITHOUT, ends, np.ones_like(ends), "dashed", BEFORE) if flat else None,
        Mark(WITH, found.x, found.y, "solid", AFTER),
        Mark("measured", found.measured_x, found.measured_y, "dots"),
    ]
    kept = [mark for mark in marks if mark is not None and len(mark.points)]
    scale = "linear linear" if flat else "log log"
    return lines(found.title, kept, (found.x_label, found.y_label), scale)


def intervals(finding: Finding, diagnosis: Diagnosis) -> str:
    """Return the values of an effect that have one unit, with their intervals: 0 is
    none of it."""
    known, units = {}, []
    for name, one in finding.parameters.items():
        scale, unit = scale_of(finding.name, name, one.unit, diagnosis)
        if np.isfinite([scale, one.value, *one.ci95]).all():
            units.append(unit)
            if unit == units[0]:
                known[name] = scale * np.array([one.value, *one.ci95])
    if not known:
        return ""
    names = list(known)[:MOST_VALUES]
    x = np.arange(float(len(names)))
    values, *ends = np.array([known[name] for name in names]).T
    marks = [
        Mark("value", x, values, "solid", AFTER),
        Mark("95 %", x, ends[0], "dots"),
        Mark("", x, ends[1], "dots"),
    ]
    words = [name.replace("_", " ") for name in names]
    title = f"Values of {words_of(finding.name)} with 95 % intervals; 0 is none"
    return bars(title, words, marks, f"{units[0] or 'value'}; 0 is none")


def histograms(before: Histogram | None, after: Histogram | None) -> str:
    """Return the residuals of images before and after, and the normal law."""
    marks = []
    for pair, label, style, color in (
        (before, OF_PROFILE, "dashed", BEFORE),
        (after, FOUND, "solid", AFTER),
    ):
        if pair is None or not np.sum(pair[1]) > 0:
            continue
        edges, counts = (np.asarray(one, float) for one in pair)
        middles = (edges[1:] + edges[:-1]) / 2
        density = counts / counts.sum() / np.diff(edges)
        density[density <= 0] = np.nan
        marks.append(Mark(label, middles, density, style, color))
    if not marks:
        return ""
    z = np.linspace(-4, 4, 81)
    normal = np.exp(-(z**2) / 2) / np.sqrt(2 * np.pi)
    marks.append(Mark("noise alone", z, normal, "dotted"))
    labels = ("residual, standard deviations", "density")
    return lines("Histogram of the residuals of images", marks, labels, "linear log")


def overview(diagnosis: Diagnosis) -> Sequence[str]:
    """Return the charts of no effect alone."""
    named = {one.name for one in diagnosis.effects}
    found = [svg_of(one) for one in diagnosis.charts if one.effect not in named]
    found += [curve(one) for one in diagnosis.curves if one.effect not in named]
    found.append(histograms(diagnosis.histogram_before, diagnosis.histogram_after))
    return [one for one in found if one]
