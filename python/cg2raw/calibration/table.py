# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Table: the numbers of a calibration as a reader of EMVA 1288 expects them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.darks import LEAST_LAMBDA
from cg2raw.calibration.fitting import OF_LIGHT
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.structure import EXTENTS
from cg2raw.normal import TUKEY_LAMBDA

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


Line = tuple[str, Measured | None, str]  # name, value, more of a row


def rows_of(found: Calibration) -> list[Row]:
    """Return all numbers of a calibration in the order of the physics."""
    sections = {
        "black": black_lines,
        "noise": noise_lines,
        "dark current": dark_lines,
        "light": light_lines,
    }
    gain, rows = found.figure("gain"), []
    for section, lines in sections.items():
        for name, value, more in lines(found):
            electrons = None  # the black level is no charge
            if value and gain and value.unit[:2] == "DN" and name != BLACK[0]:
                errors = (
                    value.standard_error * gain.value,
                    value.value * gain.standard_error,
                )
                unit, size = value.unit.replace("DN", "e-"), value.value * gain.value
                electrons = Measured(size, math.hypot(*errors), unit)
            rows.append(Row(section, name, value, electrons, more))
    return rows


def black_lines(found: Calibration) -> Iterator[Line]:
    """Yield what stands in a dark of no time."""
    yield from figures(found, BLACK)
    s = found.structure
    yield "ramp, left to right", s.horizontal if s else None, ""
    yield "ramp, top to bottom", s.vertical if s else None, ""
    if s is not None and s.edge is not None and s.edge_length is not None:
        at = f"{s.edge_length.value:.3g} px, where the search ends"
        over = f"more than {at}" if s.edge_is_longer else told(s.edge_length)
        yield "first columns", None if s.edge_is_longer else s.edge, f"over {over}"
    yield from figures(found, PATTERNS)


def noise_lines(found: Calibration) -> Iterator[Line]:
    """Yield the noise of a dark of no time."""
    yield from figures(found, NOISE)
    tails, shape = found.tails, ""
    if tails is not None and tails.tukey_lambda is not None:
        beyond = "at most " if tails.tukey_lambda <= LEAST_LAMBDA else ""
        shape = (
            f"Tukey lambda {beyond}{tails.tukey_lambda:.2f} (normal: {TUKEY_LAMBDA})"
        )
    yield "excess kurtosis", tails.excess_kurtosis if tails else None, shape


def dark_lines(found: Calibration) -> Iterator[Line]:
    """Yield what gathers with time."""
    if found.dark is None:
        yield "dark current, median", None, ""
        return
    for temperature, rate in found.dark.rates:
        at = "" if temperature is None else f"at {temperature:.1f} C"
        yield "dark current, median", rate, at
    yield "doubling temperature", found.dark.doubling, ""
    if (s := found.spread) is not None:
        quantiles = "  ".join(
            f"{100 * share:g} %: {value:.3g}" for share, value in s.quantiles.items()
        )
        words = f"{s.uneven_words}; " if s.uneven_words else ""
        words += f"above the median, DN/s: {quantiles}"
        yield "nonuniformity, rate", s.rate if s.is_uneven else None, words
        log_sigma = s.log_sigma if s.is_uneven else None
        yield "nonuniformity, sigma of log", log_sigma, s.uneven_words
        share = s.fraction.scaled(100, "%") if s.has_hot else None
        yield "hot pixels", share, s.hot_words
        yield "hot pixels, mean rate", s.hot_rate if s.has_hot else None, ""
    yield from figures(found, DARK)
    if (g := found.glow) is not None and g.stands_out:
        at = f"from row {g.row.value:+.2g}, column {g.column.value:+.2g}"
        at += "" if g.is_measured else f": wider than {EXTENTS[-1]:g} half diagonals"
        yield "amplifier glow", g.per_second if g.is_measured else None, at


def light_lines(found: Calibration) -> Iterator[Line]:
    """Yield what light shows."""
    transfer, light = found.transfer, found.light
    gain, *others = OF_LIGHT
    yield from figures(found, (gain,))
    yield "saturation", transfer.saturation, transfer.clipped_by
    yield "dynamic range", dynamic_range(found), ""
    yield "linearity error", found.linearity.error if found.linearity else None, ""
    yield from figures(found, others)
    residual = Measured(100 * light.residual, 0.0, "%") if light else None
    yield "shading besides, as of dust", residual, ""
    yield "lamp, frame to frame", found.lamp and found.lamp.scaled(100, "%"), ""


def figures(found: Calibration, names: Sequence[str]) -> Iterator[Line]:
    """Yield figures of the fit, the mean of all sites: of few sites with each of them,
    of one with the 95 % interval; those missing without."""
    for name in names:
        value, more = found.figure(name), ""
        scale = 100 if name in ("PRNU", "shading") else 1
        if value is not None and scale == 100:
            value = value.scaled(scale, "%")
        listed = [one for one in found.fit.figures if one.name == name]
        if len(listed) == 1:
            ends = listed[0].low * scale, listed[0].high * scale
            more = "95 %: {:.5g} to {:.5g}".format(*ends)
        elif 1 < len(listed) <= MOST_SITES:
            pairs = zip(found.sites.names, found.each(name), strict=True)
            more = "  ".join(f"{site} {digits(m)[0]}".strip() for site, m in pairs)
        yield ROWS.get(name, name), value, more


def dynamic_range(found: Calibration) -> Measured | None:
    """Return saturation over temporal dark noise, dB; None if either is not known."""
    full, noise = found.transfer.saturation, found.figure("temporal dark noise")
    if full is None or noise is None:
        return None
    errors = (one.standard_error / one.value for one in (full, noise))
    error = 20 / math.log(10) * math.hypot(*errors)
    return Measured(20 * math.log10(full.value / noise.value), error, "dB")


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


def as_text(found: Calibration) -> str:
    """Return the table for a terminal."""
    lines, section = [], ""
    for row in rows_of(found):
        if row.section != section:
            section = row.section
            lines.append(section)
        value = told(row.value) if row.value else "-"
        electrons = told(row.electrons) if row.electrons else ""
        lines.append(f"  {row.name:29}{value:26}{electrons:24}{row.more}".rstrip())
    for group, count in found.transients.items():
        lines.append(f"{'transients':31}{count} pixels in {group}, left out")
    lines += [f"{'note':31}{note}" for note in found.notes]
    return "\n".join(lines)
