# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Table: the numbers of a calibration as a reader of EMVA 1288 expects them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cg2raw.calibration.fitting import OF_LIGHT
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.structure import EXTENTS
from cg2raw.calibration.tails import LEAST_LAMBDA
from cg2raw.model.figures import Figure

# Figures of the fit of all frames, by section.
BLACK = ("black level", "black level drift")
PATTERNS = ("bias structure", "DSNU", "fixed column pattern", "fixed row pattern")
NOISE = (
    "temporal dark noise",
    "read noise",
    "row noise",
    "column noise",
    "correlation, next in row",
    "correlation, next in column",
)
DARK = ("dark current nonuniformity", "glow")
# What the table calls them, if not by their own names.
ROWS = {
    "black level drift": "drift, frame to frame",
    "shading": "shading, rms",
    "glow": "dark current structure",
}
MOST_SITES = 4  # of which each is told


@dataclass(frozen=True)
class Row:
    """One line. value : None if the frames do not show it. electrons : the same in
    electrons, where there is a gain. more : each site, or what else is to be said."""

    section: str
    name: str
    value: Measured | None
    electrons: Measured | None = None
    more: str = ""


def rows_of(found: Measurements) -> list[Row]:
    """Return all numbers of a calibration in the order of the physics."""
    parts = (black_rows, noise_rows, dark_rows, light_rows)
    return [row for part in parts for row in part(found)]


def in_electrons(found: Measurements, value: Measured | None) -> Measured | None:
    """Return DN (or DN/s) in electrons; None without a gain."""
    gain = found.figure("gain")
    if value is None or gain is None:
        return None
    unit = value.unit.replace("DN", "e-")
    product = value.value * gain.value
    parts = (
        value.standard_error * gain.value,
        value.value * gain.standard_error,
    )
    return Measured(product, math.hypot(*parts), unit)


def black_rows(found: Measurements) -> Iterator[Row]:
    """Yield what stands in a dark of no time."""

    def row(name: str, value: Measured | None, more: str = "") -> Row:
        return Row("black", name, value, in_electrons(found, value), more)

    yield from figures(found, "black", BLACK)
    s = found.structure
    yield row("ramp, left to right", s.horizontal if s else None)
    yield row("ramp, top to bottom", s.vertical if s else None)
    if s is not None and s.edge is not None and s.edge_length is not None:
        at = f"{s.edge_length.value:.3g} px, where the search ends"
        over = f"more than {at}" if s.edge_is_longer else told(s.edge_length)
        edge = None if s.edge_is_longer else s.edge
        yield row("first columns", edge, f"over {over}")
    yield from figures(found, "black", PATTERNS)


def noise_rows(found: Measurements) -> Iterator[Row]:
    """Yield the noise of a dark of no time."""
    yield from figures(found, "noise", NOISE)
    tails, shape = found.tails, ""
    if tails is not None and tails.tukey_lambda is not None:
        beyond = "at most " if tails.tukey_lambda <= LEAST_LAMBDA else ""
        shape = f"Tukey lambda {beyond}{tails.tukey_lambda:.2f} (normal: 0.14)"
    kurtosis = tails.excess_kurtosis if tails else None
    yield Row("noise", "excess kurtosis", kurtosis, None, shape)


def dark_rows(found: Measurements) -> Iterator[Row]:
    """Yield what gathers with time."""
    if found.dark is None:
        yield Row("dark current", "dark current, median", None)
        return
    for temperature, rate in found.dark.rates:
        at = "" if temperature is None else f"at {temperature:.1f} C"
        name = "dark current, median"
        yield Row("dark current", name, rate, in_electrons(found, rate), at)
    yield Row("dark current", "doubling temperature", found.dark.doubling)
    s = found.spread
    if s is not None:
        quantiles = "  ".join(
            f"{100 * share:g} %: {value:.3g}" for share, value in s.quantiles.items()
        )
        middle = s.rate if s.is_uneven else None
        words = f"{s.uneven_words}; " if s.uneven_words else ""
        yield Row(
            "dark current",
            "nonuniformity, rate",
            middle,
            in_electrons(found, middle),
            f"{words}above the median, DN/s: {quantiles}",
        )
        log_sigma = s.log_sigma if s.is_uneven else None
        name = "nonuniformity, sigma of log"
        yield Row("dark current", name, log_sigma, None, s.uneven_words)
        share = s.fraction.scaled(100, "%") if s.has_hot else None
        yield Row("dark current", "hot pixels", share, None, s.hot_words)
        hot = s.hot_rate if s.has_hot else None
        name = "hot pixels, mean rate"
        yield Row("dark current", name, hot, in_electrons(found, hot))
    yield from figures(found, "dark current", DARK)
    g = found.glow
    if g is not None and g.stands_out:
        at = f"from row {g.row:+.0f}, column {g.column:+.0f}"
        value = g.per_second if g.is_measured else None
        at += "" if value else f": wider than {EXTENTS[-1]:g} half diagonals"
        shine = in_electrons(found, value)
        yield Row("dark current", "amplifier glow", value, shine, at)


def light_rows(found: Measurements) -> Iterator[Row]:
    """Yield what light shows."""
    t, light = found.transfer, found.light
    gain, prnu, shading = OF_LIGHT
    yield from figures(found, "light", (gain,))
    full = t.saturation if t else None
    clipped = t.clipped_by if t else ""
    yield Row("light", "saturation", full, in_electrons(found, full), clipped)
    yield Row("light", "dynamic range", dynamic_range(found))
    x = found.linearity
    yield Row("light", "linearity error", x.error if x else None)
    yield from figures(found, "light", (prnu, shading))
    residual = Measured(100 * light.residual, 0.0, "%") if light else None
    yield Row("light", "shading besides, as of dust", residual)
    lamp = found.lamp.scaled(100, "%") if found.lamp else None
    yield Row("light", "lamp, frame to frame", lamp)


def figures(found: Measurements, section: str, names: Sequence[str]) -> Iterator[Row]:
    """Yield figures of the fit, the mean of all sites: of few sites with each of them,
    of one with the 95 % interval; those missing without."""
    for name in names:
        value = found.figure(name)
        ratios = name in ("PRNU", "shading")
        listed = [one for one in found.fit.figures if one.name == name]
        more = each(found, found.each(name)) if len(listed) > 1 else ""
        if len(listed) == 1:
            more = interval(listed[0], 100 if ratios else 1)
        shown = value.scaled(100, "%") if ratios and value else value
        in_dn = value is not None and value.unit.startswith("DN")
        is_level = name == "black level"
        electrons = in_electrons(found, value) if in_dn and not is_level else None
        yield Row(section, ROWS.get(name, name), shown, electrons, more)


def interval(figure: Figure, scale: float) -> str:
    """Return "95 %: 1.2 to 1.4"."""
    return f"95 %: {figure.low * scale:.5g} to {figure.high * scale:.5g}"


def dynamic_range(found: Measurements) -> Measured | None:
    """Return saturation over temporal dark noise, dB; None if either is not known."""
    full = found.transfer.saturation if found.transfer else None
    noise = found.figure("temporal dark noise")
    if full is None or noise is None:
        return None
    errors = (one.standard_error / one.value for one in (full, noise))
    error = 20 / math.log(10) * math.hypot(*errors)
    return Measured(20 * math.log10(full.value / noise.value), error, "dB")


def each(found: Measurements, values: Sequence[Measured] | None) -> str:
    """Return the values of all sites, if there are a few."""
    if not values or not 1 < len(values) <= MOST_SITES:
        return ""
    pairs = zip(found.sites.names, values, strict=True)
    return "  ".join(f"{name} {digits(m)[0]}".strip() for name, m in pairs)


def digits(value: Measured) -> tuple[str, str]:
    """Return value and error with the digits that the error leaves, two of it."""
    error = value.standard_error
    if not error > 0 or not math.isfinite(error):
        return f"{value.value:.6g}", "0"
    places = min(max(1 - math.floor(math.log10(error)), 0), 9)
    return f"{value.value:.{places}f}", f"{error:.{places}f}"


def told(value: Measured) -> str:
    """Return "12.93 +- 0.05 DN"."""
    unit = "" if value.unit == "1" else f" {value.unit}"
    number, error = digits(value)
    return f"{number} +- {error}{unit}" if value.standard_error > 0 else number + unit


def as_text(found: Measurements) -> str:
    """Return the table for a terminal."""
    lines, section = [], ""
    for row in rows_of(found):
        if row.section != section:
            section = row.section
            lines.append(section)
        value = told(row.value) if row.value else "-"
        electrons = told(row.electrons) if row.electrons else ""
        lines.append(f"  {row.name:29}{value:26}{electrons:24}{row.more}".rstrip())
    hits = [t for t in found.transients if t.count]
    for t in hits:
        lines.append(f"{'transients':31}{t.count} pixels in {t.group}, left out")
    lines += [f"{'note':31}{note}" for note in found.notes]
    return "\n".join(lines)
