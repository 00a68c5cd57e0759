# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""calibration.html: a card for each curve, the table of numbers, what is missing."""

import os
from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np
from scipy.ndimage import uniform_filter

from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.darks import HISTOGRAM, DarkCurrent, Tails
from cg2raw.calibration.measured import Array, Measured
from cg2raw.calibration.structure import BiasStructure
from cg2raw.calibration.table import MOST_SITES, dynamic_range, rows_of, told
from cg2raw.io.atomic_file import write_with_folder
from cg2raw.io.map_image import SEQUENTIAL, map_image
from cg2raw.io.report_page import Box, Card, Image, Page, Table, html_of
from cg2raw.io.svg import AFTER, BEFORE, INK, SHAPES, SITES, Mark, lines
from cg2raw.normal import CI95
from cg2raw.short_messages import plural

PAGE = "calibration.html"
BINS = 8  # of the blocks of a flat, by their level, that are drawn
MOST_POINTS = 256  # of a profile
WINDOW = 15  # px of one site, across, that the fine response is over
ACROSS = 192  # cells of a map along its longer side
SHOWN = (0.5, 99.5)  # per cent of the values that a scale spans
QUANTITIES = ("quantity (EMVA 1288)", "value, standard error", "in electrons", "")


def write_report(found: Calibration, folder: str) -> str:
    """Write calibration.html into a folder, which is made if it is not there; return
    the page's path. Raises ValueError if Jinja2 or Pillow is missing, OSError; a folder
    that was not there is not there then."""
    path = os.path.join(folder, PAGE)
    write_with_folder(path, html_of(page_of(found)).encode())
    return path


def page_of(found: Calibration) -> Page:
    """Return what the page says. Raises ValueError if Pillow is missing."""
    gain, rows = found.figure("gain"), rows_of(found)
    darks, flats = found.frames
    size = f"{found.shape[1]} x {found.shape[0]} pixels"
    iso = [] if found.iso is None else [f"ISO {found.iso:g}"]
    missing = [row.name for row in rows if row.value is None]
    text = f"{plural(darks, 'dark')} and {plural(flats, 'flat')}."
    if missing:
        text += f" Not shown by these frames: {', '.join(dict.fromkeys(missing))}."
    headline = "One electron is not known in DN: flats are needed"
    if gain is not None:
        headline = f"{words(gain).replace('e-/DN', 'electrons per DN')}"
    numbers = {
        "temporal dark noise": found.figure("temporal dark noise"),
        "saturation": found.transfer.saturation,
        "dynamic range": dynamic_range(found),
    }
    tables = []
    for section, some in groupby(rows, lambda row: row.section):
        cells = [
            (
                row.name,
                words(row.value) if row.value else "not shown by these frames",
                words(row.electrons) if row.electrons else "",
                row.more,
            )
            for row in some
        ]
        table = Table(QUANTITIES, cells, 4)
        note = plural(len(cells), "row")
        tables.append(Box(f"Numbers: {section}", note, tables=[table]))
    sentences = [*found.notes] or ["Nothing is missing."]
    sentences += [
        f"Transients: {count} pixels in {group} lie far above their repeats (cosmic "
        "rays, flicker) and are left out."
        for group, count in found.transients.items()
    ]
    lacking = "What these frames could not show, and which would"
    return Page(
        title=f"{found.sensor.id}: calibration",
        eyebrow=" \N{MIDDLE DOT} ".join(
            ["cg2raw calibrate", found.sensor.id, *iso, size]
        ),
        badge=("calibrated", "good" if gain is not None else "doubt"),
        headline=headline,
        text=text,
        numbers=[(name, "", words(one)) for name, one in numbers.items() if one],
        cards=list(cards(found)),
        boxes=[Box(lacking, sentences=sentences)],
        folds=[*tables, Box("Maps", "means of cells", images=list(maps(found)))],
        footer="Errors are one standard error, intervals hold with 95 %.",
    )


def words(value: Measured) -> str:
    """Return a number with its error."""
    return told(value).replace("+-", "\N{PLUS-MINUS SIGN}")


def interval(value: Measured | None) -> str:
    """Return the 95 % interval of a number, "" of none."""
    if value is None:
        return ""
    half = CI95 * value.standard_error
    ends = (Measured(value.value + n * half, half, "") for n in (-1, 1))
    low, high = (told(one).partition(" ")[0] for one in ends)
    unit = "" if value.unit == "1" else f" {value.unit}"
    return f"95 %: {low} to {high}{unit}"


def card(
    title: str, value: str, of: Measured | None, evidence: str, *charts: str
) -> Card:
    """Return a card of a value, with the interval of the number that it is of."""
    return Card(title, "", value, interval(of), evidence, charts=charts)


def cards(found: Calibration) -> Iterator[Card]:
    """Yield a card for each curve that the frames show."""
    if found.transfer.points and (gain := found.figure("gain")) is not None:
        yield from transfer(found, gain)
    if (line := found.linearity) is not None:
        flat = np.array([line.levels.min(), line.levels.max()])
        marks = [
            Mark("linear", flat, np.zeros(2), "dashed", BEFORE),
            Mark("flats", line.levels, line.deviations, "dots"),
        ]
        chart = lines("Linearity", marks, ("signal, DN", "deviation, %"))
        evidence = "Level against exposure time; the error is the mean deviation."
        yield card(
            "Linearity", f"error {words(line.error)}", line.error, evidence, chart
        )
    if found.dark is not None:
        yield dark_current(found.dark)
    if found.tails is not None:
        yield temporal_noise(found.tails, found.figure("temporal dark noise"))
    if found.structure is not None:
        yield bias(found.structure, found.figure("black level"))


def transfer(found: Calibration, gain: Measured) -> Iterator[Card]:
    """Yield variance against mean, and the line of the gain; and signal over noise, of
    a pixel from frame to frame, and with patterns."""
    points = found.transfer.points
    top = max(float(point.mean.max()) for point in points)
    x = np.geomspace(max(top / 1e4, 0.1), top, 60)
    each = found.dark_variance
    dark = float(each.mean()) if len(each) else 0.0
    temporal = dark + x / gain.value
    variances = [
        Mark("with shot noise", x, temporal, "solid", AFTER),
        Mark("dark", x, np.full_like(x, dark), "dotted", INK),
    ]
    ratios = [Mark("in time", x, x / np.sqrt(temporal), "solid", AFTER)]
    prnu, dsnu = (found.figure(name) for name in ("PRNU", "DSNU"))
    if prnu is not None:
        spatial = (prnu.value * x) ** 2 + (dsnu.value**2 if dsnu is not None else 0.0)
        total = x / np.sqrt(temporal + spatial)
        ratios.append(Mark("with patterns", x, total, "dashed", BEFORE))
    for site in range(min(found.sites.count, MOST_SITES)):
        name, both = found.sites.names[site] or "flats", []
        for point in points:  # blocks of the field of like levels together
            order = np.argsort(point.mean[site])
            for some in np.array_split(order, min(BINS, len(order))):
                pair = point.mean[site][some].mean(), point.variance[site][some].mean()
                both.append(pair)
        mean, variance = np.transpose(both)
        style = ("dots", SITES.get(name, INK), SHAPES[site])
        variances.append(Mark(name, mean, variance, *style))
        ratio = mean / np.sqrt(np.maximum(variance, 1e-300))
        ratios.append(Mark(name, mean, ratio, *style))
    labels = ("signal, DN", "variance, DN\N{SUPERSCRIPT TWO}")
    chart = lines("Photon transfer", variances, labels, "log log")
    evidence = "Shot noise grows with the signal: its slope is the system gain."
    yield card("Photon transfer", words(gain), gain, evidence, chart)
    chart = lines("Signal to noise", ratios, ("signal, DN", "SNR"), "log log")
    best = float(np.nanmax(ratios[0].y))
    value = f"at most {best:.3g} = {20 * np.log10(best):.1f} dB in these flats"
    evidence = "By the noise of darks and photons; patterns lower it at high signals."
    yield card("Signal to noise", value, None, evidence, chart)


def dark_current(dark: DarkCurrent) -> Card:
    """Return the middles of darks against exposure time, a line per temperature."""
    times = np.array([0.0, max(time for time, *_ in dark.points)])
    marks = []
    for number, (temperature, rate) in enumerate(dark.rates):
        at = "darks" if temperature is None else f"{temperature:.1f} C"
        ours = np.array([(time, y) for time, y, of in dark.points if of == number])
        style = ("solid", "dashed", "dotted")[number % 3]
        marks.append(Mark("", times, rate.value * times, style, AFTER))
        shape = SHAPES[number % len(SHAPES)]
        if len(ours):
            marks.append(Mark(at, ours[:, 0], ours[:, 1], "dots", INK, shape))
    chart = lines("Dark current", marks, ("exposure time, s", "median, DN"))
    evidence = "The median pixel of darks above the black level."
    more = [f"Doubles in {words(dark.doubling)}"] if dark.doubling else []
    of = words(dark.rate), interval(dark.rate)
    return Card("Dark current", "", *of, evidence, more, [chart])


def temporal_noise(tails: Tails, noise: Measured | None) -> Card:
    """Return the histogram of differences of darks against a normal one."""
    middles = (HISTOGRAM[1:] + HISTOGRAM[:-1]) / 2
    density = tails.histogram / tails.histogram.sum() / np.diff(HISTOGRAM)
    normal = np.exp(-(middles**2) / 2) / np.sqrt(2 * np.pi)
    seen = density > 0
    normal[normal < 0.3 * density[seen].min(initial=1.0)] = np.nan
    marks = [
        Mark("normal", middles[seen], normal[seen], "dashed", BEFORE),
        Mark("darks", middles[seen], density[seen], "dots"),
    ]
    labels = ("difference of two darks, standard deviations", "density")
    chart = lines("Temporal noise", marks, labels, "linear log")
    evidence = f"Differences of {tails.frames} darks, in which fixed patterns cancel."
    value = "not shown" if noise is None else words(noise)
    return card("Temporal dark noise", value, noise, evidence, chart)


def bias(structure: BiasStructure, level: Measured | None) -> Card:
    """Return the means of columns and rows of the offsets, with what was fitted."""
    charts = []
    for name, profile, fitted in (
        ("column", structure.columns, structure.fitted_columns),
        ("row", structure.rows, structure.fitted_rows),
    ):
        step = -(-len(profile) // MOST_POINTS)
        count = len(profile) // step
        x = (np.arange(count) + 0.5) * step
        both = np.array([profile, fitted])[:, : count * step]
        means, curve = both.reshape(2, count, step).mean(axis=2)
        marks = [
            Mark("means", x, means, "solid", INK),
            Mark("ramp and edge", x, curve, "dashed", BEFORE),
        ]
        charts.append(lines(f"Means of {name}s of the bias", marks, (name, "DN")))
    value = "" if level is None else f"black level {words(level)}"
    evidence = "Means of columns and of rows of the bias, less the black level."
    return card("Bias profiles", value, None, evidence, *charts)


def maps(found: Calibration) -> Iterator[tuple[str, Sequence[Image]]]:
    """Yield each map that the frames show, with its caption."""
    if found.offset is not None:
        yield drawn_map(
            "Bias: offsets of pixels above the black level", found.offset, "DN"
        )
    if found.rate is not None and found.dark is not None:
        rate = found.rate + (found.dark.rate.value - np.median(found.rate))
        yield drawn_map("Dark current of pixels", rate, "DN/s")
    if found.response is not None and found.light is not None:
        fine = np.zeros_like(found.response)
        views = map(found.sites.of, (found.response, fine))
        for plane, out in zip(*views, strict=True):
            out[:] = 100 * (plane / uniform_filter(plane, WINDOW) - 1)
        title = f"PRNU: response of pixels over {WINDOW} x {WINDOW} of their own"
        yield drawn_map(title, fine, "%")
        title = "Shading: response in blocks of the field, light and lens"
        yield drawn_map(title, 100 * found.light.field, "%")


def drawn_map(title: str, values: Array, unit: str) -> tuple[str, Sequence[Image]]:
    """Return a map, (h, w), as means of cells, and its caption with its ends."""
    step = max(1, -(-max(values.shape) // ACROSS))
    rows, cols = (side // step for side in values.shape)
    cut = values[: rows * step, : cols * step]
    cells = cut.reshape(rows, step, cols, step).mean((1, 3), dtype=np.float64)
    known = cells[np.isfinite(cells)]
    low, high = np.percentile(known, SHOWN) if known.size else (0.0, 1.0)
    caption = f"{title}: dark {low:.3g}, bright {high:.3g} {unit}"
    return caption, [map_image(cells, (float(low), float(high)), caption, SEQUENTIAL)]
