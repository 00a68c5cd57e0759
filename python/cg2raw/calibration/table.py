# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Table: the numbers of a calibration as a reader of EMVA 1288 expects them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cg2raw.calibration.glow import EXTENTS
from cg2raw.calibration.measured import Measured, ratio, root_of
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.temporal_noise import LEAST_LAMBDA

LOST_WORDS = {
    "": "",
    "cut": "of the flats' line: that of darks is cut",
    "coarse": "by the shares of few codes, fixed patterns included",
}
# Figures of the fit of all frames, among what is of their kind.
IN_BLACK = ("fixed column pattern", "fixed row pattern", "DSNU")
IN_NOISE = (
    "row noise",
    "column noise",
    "correlation, next in row",
    "correlation, next in column",
)
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
    parts = (
        black_rows(found),
        noise_rows(found),
        dark_rows(found),
        light_rows(found),
        fit_rows(found),
    )
    return [row for part in parts for row in part]


def in_electrons(found: Measurements, value: Measured | None) -> Measured | None:
    """Return DN (or DN/s) in electrons; None without a gain."""
    if value is None or found.transfer is None:
        return None
    unit = value.unit.replace("DN", "e-")
    gain = found.transfer.mean_gain
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

    levels = found.black_level
    mean = mean_of(levels) if levels else None
    yield Row("black", "black level", mean, None, each(found, levels))
    yield row("drift, frame to frame", found.drift)
    s = found.structure
    yield row("ramp, left to right", s.horizontal if s else None)
    yield row("ramp, top to bottom", s.vertical if s else None)
    if s is not None and s.edge is not None and s.edge_length is not None:
        at = f"{s.edge_length.value:.3g} px, where the search ends"
        over = f"more than {at}" if s.edge_is_longer else told(s.edge_length)
        edge = None if s.edge_is_longer else s.edge
        yield row("first columns", edge, f"over {over}")
    yield from figures(found, "black", IN_BLACK)


def noise_rows(found: Measurements) -> Iterator[Row]:
    """Yield the noise of a dark of no time."""
    n = found.noise
    read = n.mean_read_noise if n else lost_noise(found)
    more = each(found, n.read_noise) if n else LOST_WORDS[found.lost if read else ""]
    yield Row("noise", "temporal dark noise", read, in_electrons(found, read), more)
    yield from figures(found, "noise", IN_NOISE)
    shape = ""
    if n is not None and n.tukey_lambda is not None:
        beyond = "at most " if n.tukey_lambda <= LEAST_LAMBDA else ""
        shape = f"Tukey lambda {beyond}{n.tukey_lambda:.2f} (normal: 0.14)"
    kurtosis = n.excess_kurtosis if n else None
    yield Row("noise", "excess kurtosis", kurtosis, None, shape)


def lost_noise(found: Measurements) -> Measured | None:
    """Return the noise of a dark that darks do not show themselves, DN, if any does."""
    parts = found.read_variance
    if parts is None or not (found.few_codes or found.lost == "cut"):
        return None
    mean = mean_of(parts)
    return root_of(mean.value + found.sites.rounding, mean.standard_error, "DN")


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
    yield Row("light", "gain", t.mean_gain if t else None, None, gains(found))
    full = t.saturation if t else None
    clipped = t.clipped_by if t else ""
    yield Row("light", "saturation", full, in_electrons(found, full), clipped)
    yield Row("light", "dynamic range", dynamic_range(found))
    x = found.linearity
    yield Row("light", "linearity error", x.error if x else None)
    prnu = light.prnu.scaled(100, "%") if light else None
    yield Row("light", "PRNU", prnu)
    fall_off = light.fall_off.scaled(100, "%") if light else None
    more = f"{100 * light.residual:.2f} % besides, as of dust" if light else ""
    yield Row("light", "shading, rms", fall_off, None, more)
    lamp = found.lamp.scaled(100, "%") if found.lamp else None
    yield Row("light", "lamp, frame to frame", lamp)


def fit_rows(found: Measurements) -> Iterator[Row]:
    """Yield the other figures of all frames by one likelihood."""
    shown = (*IN_BLACK, *IN_NOISE)
    others = [one.name for one in found.figures if one.name not in shown]
    yield from figures(found, "all frames, by one likelihood", [*dict.fromkeys(others)])


def figures(found: Measurements, section: str, names: Sequence[str]) -> Iterator[Row]:
    """Yield figures of the fit with their 95 % intervals; those missing without."""
    missing = set(names) - {one.name for one in found.figures}
    yield from (Row(section, name, None) for name in names if name in missing)
    for one in found.figures:
        if one.name not in names:
            continue
        name = one.name
        if one.site is not None and found.sites.names[one.site]:
            if len(found.sites.names) > MOST_SITES:
                continue
            name += f" {found.sites.names[one.site]}"
        scale, unit = (100, "%") if one.unit == "1" else (1, one.unit)
        if name.startswith("correlation"):
            scale, unit = 1, "1"
        value = Measured(one.value, one.standard_error, one.unit).scaled(scale, unit)
        ends = f"95 %: {one.low * scale:.5g} to {one.high * scale:.5g}"
        in_dn = one.unit.startswith("DN") and one.name != "black level"
        electrons = in_electrons(found, value) if in_dn else None
        yield Row(section, name, value, electrons, ends)


def gains(found: Measurements) -> str:
    """Return the gain of each site, electrons per DN."""
    if found.transfer is None:
        return ""
    one = Measured(1.0, 0.0, "e-")
    return each(found, [ratio(one, m, "e-/DN") for m in found.transfer.system_gain])


def dynamic_range(found: Measurements) -> Measured | None:
    """Return saturation over temporal dark noise, dB; None if either is not known."""
    full = found.transfer.saturation if found.transfer else None
    if full is None or found.noise is None:
        return None
    quotient = ratio(full, found.noise.mean_read_noise, "1")
    error = 20 / math.log(10) * quotient.standard_error / quotient.value
    return Measured(20 * math.log10(quotient.value), error, "dB")


def mean_of(values: Sequence[Measured]) -> Measured:
    """Return the mean of sites, whose errors are mostly one."""
    return Measured(
        sum(m.value for m in values) / len(values),
        max(m.standard_error for m in values),
        values[0].unit,
    )


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
