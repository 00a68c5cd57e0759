# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""calibration.html: a card for each curve, the table of numbers, what is missing."""

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np
from scipy.ndimage import uniform_filter

from cg2raw.calibration.darks import HISTOGRAM
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.robust import Array
from cg2raw.calibration.table import Row, dynamic_range, rows_of, told
from cg2raw.io.map_image import SEQUENTIAL, map_image
from cg2raw.io.report_page import Box, Card, Image, Page, Table
from cg2raw.io.svg import AFTER, BEFORE, INK, SHAPES, SITES, Mark, lines
from cg2raw.model.figures import NORMAL
from cg2raw.short_messages import plural

BINS = 8  # of the blocks of a flat, by their level, that are drawn
MOST_POINTS = 256  # of a profile
MOST_SITES = 4  # that are drawn each for itself
WINDOW = 15  # px of one site, across, that the fine response is over
ACROSS = 192  # cells of a map along its longer side
SHOWN = (0.5, 99.5)  # per cent of the values that a scale spans
QUANTITIES = ("quantity (EMVA 1288)", "value, standard error", "in electrons", "")


def page_of(found: Measurements) -> Page:
    """Return what the page says. Raises ValueError if Pillow is missing."""
    gain = found.figure("gain")
    darks, flats = found.frames
    size = f"{found.shape[1]} x {found.shape[0]} pixels"
    iso = [] if found.iso is None else [f"ISO {found.iso:g}"]
    eyebrow = " \N{MIDDLE DOT} ".join(["cg2raw calibrate", found.sensor.id, *iso, size])
    missing = [row.name for row in rows_of(found) if row.value is None]
    text = f"{plural(darks, 'dark')} and {plural(flats, 'flat')}."
    if missing:
        text += f" Not shown by these frames: {', '.join(dict.fromkeys(missing))}."
    headline = "One electron is not known in DN: flats are needed"
    if gain is not None:
        headline = f"{words(gain).replace('e-/DN', 'electrons per DN')}"
    numbers = [
        (name, "", words(value))
        for name, value in (
            ("temporal dark noise", found.figure("temporal dark noise")),
            ("saturation", found.transfer.saturation if found.transfer else None),
            ("dynamic range", dynamic_range(found)),
        )
        if value is not None
    ]
    return Page(
        title=f"{found.sensor.id}: calibration",
        eyebrow=eyebrow,
        badge=("calibrated", "good" if gain is not None else "doubt"),
        headline=headline,
        text=text,
        numbers=numbers,
        cards=list(cards(found)),
        boxes=[notes(found)],
        folds=[*tables(found), Box("Maps", "means of cells", images=list(maps(found)))],
        footer="Errors are one standard error, intervals hold with 95 %.",
    )


def words(value: Measured) -> str:
    """Return a number with its error."""
    return told(value).replace("+-", "\N{PLUS-MINUS SIGN}")


def interval(value: Measured) -> str:
    """Return the 95 % interval of a number."""
    half = NORMAL * value.standard_error
    ends = (Measured(value.value + n * half, half, "") for n in (-1, 1))
    low, high = (told(one).partition(" ")[0] for one in ends)
    unit = "" if value.unit == "1" else f" {value.unit}"
    return f"95 %: {low} to {high}{unit}"


def cards(found: Measurements) -> Iterator[Card]:
    """Yield a card for each curve that the frames show."""
    gain = found.figure("gain")
    if found.transfer is not None and gain is not None:
        yield transfer(found, gain)
        yield signal_to_noise(found, gain)
    if found.linearity is not None:
        yield linearity(found)
    if found.dark is not None:
        yield dark_current(found)
    if found.tails is not None:
        yield temporal_noise(found)
    if found.structure is not None:
        yield bias(found)


def dark_variance(found: Measurements) -> float:
    """Return the variance of a dark of no time, rounding included, DN^2."""
    read = [one.value**2 + found.sites.rounding for one in found.each("read noise")]
    return float(np.mean(read)) if read else 0.0


def points_of(found: Measurements) -> Iterator[tuple[str, str, str, Array, Array]]:
    """Yield (name, colour, shape, means, variances) of flats of each site: blocks of
    the field of like levels together."""
    assert found.transfer is not None
    for site in range(min(found.sites.count, MOST_SITES)):
        means, variances = [], []
        for point in found.transfer.points:
            order = np.argsort(point.mean[site])
            for some in np.array_split(order, min(BINS, len(order))):
                means.append(point.mean[site][some].mean())
                variances.append(point.variance[site][some].mean())
        name = found.sites.names[site] or "flats"
        color = SITES.get(name, INK)
        yield name, color, SHAPES[site], np.array(means), np.array(variances)


def levels_of(found: Measurements) -> Array:
    """Return levels from far below the darkest flat to the brightest, DN."""
    assert found.transfer is not None
    top = max(float(point.mean.max()) for point in found.transfer.points)
    levels: Array = np.geomspace(max(top / 1e4, 0.1), top, 60)
    return levels


def transfer(found: Measurements, gain: Measured) -> Card:
    """Return variance against mean, and the line of the gain."""
    x, dark = levels_of(found), dark_variance(found)
    marks = [
        Mark("with shot noise", x, dark + x / gain.value, "solid", AFTER),
        Mark("dark", x, np.full_like(x, dark), "dotted", INK),
        *(Mark(n, m, v, "dots", c, s) for n, c, s, m, v in points_of(found)),
    ]
    labels = ("signal, DN", "variance, DN\N{SUPERSCRIPT TWO}")
    chart = lines("Photon transfer", marks, labels, "log log")
    evidence = "Shot noise grows with the signal: its slope is the system gain."
    return Card(
        "Photon transfer", "", words(gain), interval(gain), evidence, charts=[chart]
    )


def signal_to_noise(found: Measurements, gain: Measured) -> Card:
    """Return signal over noise: of a pixel from frame to frame, and with patterns."""
    x, dark = levels_of(found), dark_variance(found)
    prnu, dsnu = (found.figure(name) for name in ("PRNU", "DSNU"))
    temporal = dark + x / gain.value
    marks = [Mark("in time", x, x / np.sqrt(temporal), "solid", AFTER)]
    if prnu is not None:
        spatial = (prnu.value * x) ** 2 + (dsnu.value**2 if dsnu is not None else 0.0)
        total = x / np.sqrt(temporal + spatial)
        marks.append(Mark("with patterns", x, total, "dashed", BEFORE))
    for name, color, shape, mean, variance in points_of(found):
        ratio = mean / np.sqrt(np.maximum(variance, 1e-300))
        marks.append(Mark(name, mean, ratio, "dots", color, shape))
    chart = lines("Signal to noise", marks, ("signal, DN", "SNR"), "log log")
    best = max(float(np.nanmax(mark.y)) for mark in marks[:1])
    value = f"at most {best:.3g} = {20 * np.log10(best):.1f} dB in these flats"
    evidence = "By the noise of darks and photons; patterns lower it at high signals."
    return Card("Signal to noise", "", value, "", evidence, charts=[chart])


def linearity(found: Measurements) -> Card:
    """Return how flats deviate from a straight line through zero."""
    line = found.linearity
    assert line is not None
    flat = np.array([line.levels.min(), line.levels.max()])
    marks = [
        Mark("linear", flat, np.zeros(2), "dashed", BEFORE),
        Mark("flats", line.levels, line.deviations, "dots"),
    ]
    chart = lines("Linearity", marks, ("signal, DN", "deviation, %"))
    evidence = "Level against exposure time; the error is the mean deviation."
    value = f"error {words(line.error)}"
    return Card("Linearity", "", value, interval(line.error), evidence, charts=[chart])


def dark_current(found: Measurements) -> Card:
    """Return the middles of darks against exposure time, a line per temperature."""
    dark = found.dark
    assert dark is not None
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
    labels = ("exposure time, s", "median, DN")
    chart = lines("Dark current", marks, labels)
    evidence = "The median pixel of darks above the black level."
    more = [f"Doubles in {words(dark.doubling)}"] if dark.doubling else []
    return Card(
        "Dark current", "", words(dark.rate), interval(dark.rate), evidence, more,
        [chart],
    )  # fmt: skip


def temporal_noise(found: Measurements) -> Card:
    """Return the histogram of differences of darks against a normal one."""
    tails, noise = found.tails, found.figure("temporal dark noise")
    assert tails is not None
    edges: Array = np.asarray(HISTOGRAM, np.float64)
    middles: Array = (edges[1:] + edges[:-1]) / 2
    density = tails.histogram / tails.histogram.sum() / np.diff(HISTOGRAM)
    normal = np.exp(-(middles**2) / 2) / np.sqrt(2 * np.pi)
    seen = density > 0
    marks = [
        Mark("normal", middles[seen], normal[seen], "dashed", BEFORE),
        Mark("darks", middles[seen], density[seen], "dots"),
    ]
    floor = 0.3 * density[seen].min(initial=1.0)
    marks[0].y[marks[0].y < floor] = np.nan
    labels = ("difference of two darks, standard deviations", "density")
    chart = lines("Temporal noise", marks, labels, "linear log")
    evidence = f"Differences of {tails.frames} darks, in which fixed patterns cancel."
    value = "not shown" if noise is None else words(noise)
    ends = "" if noise is None else interval(noise)
    return Card("Temporal dark noise", "", value, ends, evidence, charts=[chart])


def bias(found: Measurements) -> Card:
    """Return the means of columns and rows of the offsets, with what was fitted."""
    structure = found.structure
    assert structure is not None
    charts = []
    for profile, fitted, name in (
        (structure.columns, structure.fitted_columns, "column"),
        (structure.rows, structure.fitted_rows, "row"),
    ):
        step = -(-len(profile) // MOST_POINTS)
        count = len(profile) // step
        x = (np.arange(count) + 0.5) * step
        each = [
            np.asarray(one, float)[: count * step].reshape(count, step).mean(axis=1)
            for one in (profile, fitted)
        ]
        marks = [
            Mark("means", x, each[0], "solid", INK),
            Mark("ramp and edge", x, each[1], "dashed", BEFORE),
        ]
        charts.append(lines(f"Means of {name}s of the bias", marks, (name, "DN")))
    level = found.figure("black level")
    value = "" if level is None else f"black level {words(level)}"
    evidence = "Means of columns and of rows of the bias, less the black level."
    return Card("Bias profiles", "", value, "", evidence, charts=charts)


def tables(found: Measurements) -> Iterator[Box]:
    """Yield the table of all numbers."""
    for name, rows in groupby(rows_of(found), lambda row: row.section):
        cells = [cells_of(row) for row in rows]
        yield Box(
            f"Numbers: {name}",
            plural(len(cells), "row"),
            tables=[Table(QUANTITIES, cells, 4)],
        )


def cells_of(row: Row) -> tuple[str, str, str, str]:
    """Return name, value, electrons and what else is to be said of a number."""
    value = words(row.value) if row.value else "not shown by these frames"
    return row.name, value, words(row.electrons) if row.electrons else "", row.more


def notes(found: Measurements) -> Box:
    """Return what is missing, and which frames would show it."""
    sentences = [*found.notes] or ["Nothing is missing."]
    sentences += [
        f"Transients: {count} pixels in {group} lie far above their repeats (cosmic "
        "rays, flicker) and are left out."
        for group, count in found.transients.items()
    ]
    return Box("What these frames could not show, and which would", sentences=sentences)


def maps(found: Measurements) -> Iterator[tuple[str, Sequence[Image]]]:
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
        for plane, out in zip(
            found.sites.of(found.response), found.sites.of(fine), strict=True
        ):
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
