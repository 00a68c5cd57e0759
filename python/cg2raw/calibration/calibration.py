# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Calibration: all that darks and flats show of a sensor, each with its error; and the
sensor's profile with what was measured in place of what it had.

Effects are in units of the signal, which is 1 at white, above black. One is called for
if it stands out from its standard error; where it was looked for and does not, the
profile is not to have it."""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv

from cg2raw import _core
from cg2raw.calibration.darks import DarkResults
from cg2raw.calibration.fitting import Fitted, of_all, of_sites
from cg2raw.calibration.flats import FULL_WELL, FlatResults
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites
from cg2raw.io.json_text import formatted
from cg2raw.model.values import FIGURES
from cg2raw.normal import CI95, TUKEY_LAMBDA
from cg2raw.sensor import Sensor

SOURCE = "cg2raw calibrate (EMVA 1288 R4.0)"
DIGITS = 6  # significant, of numbers in the profile
CHANCE = 1.35e-3  # of a normal deviate above three standard deviations
CORRELATION_FLOOR = 0.005  # which a few flickering pixels bring
SHADING_FLOOR = 1e-3  # rms; no lamp is flatter
STEADY = 5e-3  # relative, of a lamp and a shutter from exposure to exposure

Found = Mapping[str, float | Measured]
Answer = tuple[str, Found | None]  # an effect's name and values; None: not called for


@dataclass(frozen=True, kw_only=True)
class Calibration(DarkResults, FlatResults):
    """What frames of uniform light and of none show; None where they cannot, and why
    is in the notes.

    sensor : whose profile was given. iso : of the frames, None if nobody says it.
    shape : (H, W) px. frames : (darks, flats). fit : figures by one likelihood, and why
    darks do not show all of them. excluded : {name of a frame that is none of its
    repeats: how it is off}. transients : {group: how many pixels of single frames are
    far off their repeats, by cosmic rays or flicker}. defects : (H, W), None where
    there are none."""

    sensor: Sensor
    sites: Sites
    shape: tuple[int, int]
    iso: float | None
    frames: tuple[int, int]
    fit: Fitted = field(default_factory=Fitted)
    transients: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    excluded: Mapping[str, str] = field(default_factory=dict)
    defects: NDArray[np.bool_] | None = field(default=None, repr=False)

    def figure(self, name: str) -> Measured | None:
        """Return a figure with its standard error, the mean of all sites; None if it is
        missing. name : as in the table."""
        return of_all(self.fit.figures, name)

    def each(self, name: str) -> tuple[Measured, ...]:
        """Return a figure of each site; nothing if it is missing."""
        return of_sites(self.fit.figures, name)

    @property
    def black(self) -> NDArray[np.float64]:
        """(sites,) DN: as measured, else the profile's."""
        found = [one.value for one in self.each("black level")]
        return np.array(found or self.sensor.black_level, float)

    @property
    def range(self) -> float:
        """White above black, DN, mean of all sites: the unit of a signal."""
        return self.sensor.white_level - float(self.black.mean())

    @property
    def dark_variance(self) -> NDArray[np.float64]:
        """(sites,) DN^2 of a pixel in a dark of no time, rounding included; none where
        read noise is not known."""
        read = [one.value**2 for one in self.each("read noise")]
        return np.array(read) + self.sites.rounding

    def updated_profile(self, sensor: Sensor | None = None) -> str:
        """Return the JSON of a sensor's profile with what was measured.

        sensor : in place of the one that was calibrated. The black level, the row of
        noise at the frames' ISO and effects that stand out are replaced; effects that
        were looked for and do not are taken out; all else stays.
        Raises ValueError naming field, value and bound."""
        return updated_profile(self, sensor or self.sensor)[0]

    def profile_notes(self) -> list[str]:
        """Return what stands out and cannot be written into a profile."""
        return updated_profile(self, self.sensor)[1]


def updated_profile(found: Calibration, sensor: Sensor) -> tuple[str, list[str]]:
    """Return (JSON of a sensor's profile with what was measured, notes)."""
    profile = json.loads(sensor.to_json())
    known = {effect["name"]: effect for effect in _core.effects()}
    effects, notes = effects_found(found, has_shapes(profile)), []
    if (tails := found.tails) and tails.excess_kurtosis and tails.are_heavy:
        notes.append(
            f"read noise: its tails are not normal (excess kurtosis "
            f"{tails.excess_kurtosis.value:.2f}, Tukey lambda {tails.tukey_lambda:.2f})"
            "; rows of noise with tukey_lambda and row_sigma say that"
        )
    frames = f"{found.frames[0]} darks and {found.frames[1]} flats"
    source = f"{SOURCE}: {frames}"
    has_level = bool(found.each("black level"))
    if has_level:
        # Without the first columns' edge, where the profile has that by itself.
        has_edge = "edge" in (effects.get("bias_structure") or {})
        edge = found.structure.edge_mean if found.structure and has_edge else 0.0
        profile["black_level"] = [rounded(max(x - edge, 0.0)) for x in found.black]
        profile["sources"]["black_level"] = source
    notes += add_noise(profile, found, sensor, source)
    settings = {effect["name"]: effect for effect in profile.get("effects", [])}
    if has_level:
        settings.pop("black_level", None)  # the level itself has it now
    for name, values in effects.items():
        settings.pop(name, None)
        beyond = bounds_passed(values or {}, known[name])
        notes += [f"{name}: {words}: the profile goes without" for words in beyond]
        if values is not None and not beyond:
            settings[name] = setting(name, values, known[name], frames)
    profile["effects"] = list(settings.values())
    text = json.dumps(profile, indent=2)
    text = Sensor.from_json(text, "the calibrated profile").profile.to_json()
    if not settings:  # frames that show none say so, where a profile leaves it out
        text = formatted({**json.loads(text), "effects": []})
    return text, notes


def has_shapes(profile: dict[str, Any]) -> bool:
    """Return whether the rows of noise say how they are distributed."""
    return any("tukey_lambda" in row for row in profile.get("noise", []))


def effects_found(found: Calibration, has_shapes: bool) -> dict[str, Found | None]:
    """Return {effect: its values, None if it does not stand out}; what the frames
    cannot show is not in it.

    has_shapes : the rows of noise say row_sigma, so that rows' noise is no effect."""
    answers = dict([*of_bias(found), *of_darks(found), *of_light(found)])
    if has_shapes and "row_noise" in answers:
        answers["row_noise"] = None
    return answers


def of_bias(c: Calibration) -> Iterator[Answer]:
    """Yield what darks of no time show."""
    if (s := c.structure) is not None:
        ramps = {"horizontal": s.horizontal, "vertical": s.vertical}
        parts: dict[str, float | Measured] = {
            name: ramp.scaled(1 / c.range, "1")
            for name, ramp in ramps.items()
            if ramp.stands_out
        }
        if s.edge is not None and s.edge_length is not None and not s.edge_is_longer:
            parts["edge"] = s.edge.scaled(1 / c.range, "1")
            parts["edge_length"] = s.edge_length
        yield "bias_structure", parts or None
    for drift in c.fit.figures:
        if drift.name == "black level drift":
            # By the chi-square of its few frames: by noise it is as large in 1 of 740.
            half = drift.freedom / 2
            # The ends of its interval are those of the total less the part of noise.
            low, most = gammaincinv(half, [0.025, 1 - CHANCE]) / half
            total = (drift.high**2 - drift.value**2) / (1 / low - 1)
            is_chance = total <= most * (total - drift.value**2)
            yield from deviation(c, drift.name, is_chance)
    for name in ("fixed column pattern", "DSNU", "row noise"):
        yield from deviation(c, name)
    if (r := c.figure("correlation, next in row")) is not None:
        is_seen = r.stands_out and abs(r.value) > CORRELATION_FLOOR
        yield "read_noise_correlation", {"coefficient": r} if is_seen else None


def deviation(
    c: Calibration, name: str, is_chance: bool | None = None
) -> Iterator[Answer]:
    """Yield a deviation of the fit, by name, as its effect's sigma. is_chance : None to
    ask its error."""
    if (found := c.figure(name)) is not None:
        if is_chance is None:
            is_chance = not found.variance_stands_out
        sigma = found if found.unit == "1" else found.scaled(1 / c.range, "1")
        is_seen = found.value and not is_chance
        yield FIGURES[name][0], {"sigma": sigma} if is_seen else None


def of_darks(c: Calibration) -> Iterator[Answer]:
    """Yield what gathers with time."""
    if c.dark is not None:
        rate = c.dark.rate
        shine = c.glow.mean if c.glow is not None and c.glow.is_measured else 0.0
        without = Measured(max(rate.value - shine, 0.0), rate.standard_error, rate.unit)
        is_seen = rate.stands_out and rate.value >= 0
        values = {"per_second": without.scaled(1 / c.range, "1/s")}
        yield "dark_current", values if is_seen else None
    if (s := c.spread) is not None and not s.has_too_many_hot:
        law = {"rate": s.rate.scaled(1 / c.range, "1/s"), "log_sigma": s.log_sigma}
        yield "dark_current_nonuniformity", law if s.is_uneven else None
        hot = {"fraction": s.fraction, "rate": s.hot_rate.scaled(1 / c.range, "1/s")}
        yield "hot_pixels", hot if s.has_hot else None
    if (g := c.glow) is not None:
        glow: Found = {
            "per_second": g.per_second.scaled(1 / c.range, "1/s"),
            "row": g.row,
            "column": g.column,
            "extent": g.extent,
        }
        yield "amplifier_glow", glow if g.is_measured else None


def of_light(c: Calibration) -> Iterator[Answer]:
    """Yield what flats show, and the step of all codes."""
    yield from deviation(c, "PRNU")
    if (light := c.light) is not None:
        is_shaded = light.fall_off.stands_out and light.fall_off.value > SHADING_FLOOR
        yield "lens_shading", light.shading if is_shaded else None
    if (x := c.linearity) is not None:
        is_bent = x.quadratic.stands_out and x.bend >= STEADY
        bend = {"quadratic": x.quadratic, **({"cubic": x.cubic} if x.cubic else {})}
        yield "nonlinearity", bend if is_bent else None
    if (full := c.transfer.saturation) is not None:
        level = full.scaled(1 / c.range, "1")
        below = Measured(1 - level.value, level.standard_error, "1")
        is_full = c.transfer.clipped_by == FULL_WELL
        yield "full_well", {"below_white": below} if is_full else None
    yield "quantisation", {"step": c.sites.step / c.range} if c.sites.step > 1 else None


def add_noise(
    profile: dict[str, Any], found: Calibration, sensor: Sensor, source: str
) -> list[str]:
    """Put a row of the frames' ISO among the noise; return notes.

    beta2 is the variance of pixels alone where rows' noise is an effect, and all of it
    where rows of noise say row_sigma. Rounding to codes is not in it: it comes anew."""
    if found.iso is None or not found.fit.figures:
        return []
    betas = betas_of(found, sensor)
    if len(betas) < 2:
        lacking = "darks" if "beta1" in betas else "flats"
        if found.fit.lost:
            lacking = "flats of several levels from faint ones on"
        return [f"noise: no row is written: give {lacking}, too"]
    row: dict[str, Any] = {"iso": found.iso, **betas}
    old = {r["iso"]: r for r in profile.get("noise", [])}
    if has_shapes(profile):
        before = old.get(found.iso, profile["noise"][0])
        shape = {name: before[name] for name in ("tukey_lambda", "row_sigma")}
        if found.tails is not None:
            tail, rows = found.tails.tukey_lambda, found.figure("row noise")
            shape = {
                "tukey_lambda": rounded(TUKEY_LAMBDA if tail is None else tail),
                "row_sigma": rounded((rows.value if rows else 0.0) / found.range),
            }
        row = {**before, **row, **shape}
        row["beta2"] = [rounded(b + row["row_sigma"] ** 2) for b in row["beta2"]]
    old[found.iso] = row
    profile["noise"] = [old[iso] for iso in sorted(old)]
    was = profile["sources"].get("noise", "as before")
    others = "" if len(old) < 2 or SOURCE in was else f"; other ISOs: {was}"
    profile["sources"]["noise"] = f"ISO {found.iso:g}: {source}{others}"
    return []


def betas_of(found: Calibration, sensor: Sensor) -> dict[str, list[float]]:
    """Return beta1 and beta2 of each site, what was not measured by the profile; what
    neither says is missing."""
    count, betas = found.sites.count, dict[str, list[float]]()
    with suppress(ValueError):  # no noise at this ISO
        row = sensor.noise_at(float(found.iso or 0))
        betas = {n: list(np.broadcast_to(row[n], count)) for n in ("beta1", "beta2")}
    if gains := found.each("gain"):
        betas["beta1"] = [1 / (one.value * found.range) for one in gains]
    read = found.each("read noise")
    if read and all(one.variance_stands_out for one in read):
        betas["beta2"] = [(one.value / found.range) ** 2 for one in read]
    elif found.fit.lost == "coarse":
        betas["beta2"] = [0.0] * count
    return {name: [rounded(beta) for beta in each] for name, each in betas.items()}


def bounds_passed(values: Found, known: dict[str, Any]) -> list[str]:
    """Return sentences on measured parameters that are at a bound of the registry, as a
    search ends there, or beyond it by more than their error."""
    found = []
    for parameter in known["parameters"]:
        name, low, high = (parameter[key] for key in ("name", "min", "max"))
        given = values.get(name)
        if not isinstance(given, Measured):
            continue
        value, half = given.value, CI95 * given.standard_error
        within = value not in (low, high) and low - half < value < high + half
        if not (within or low < value < high):
            found.append(f"{name} is {value:.4g}; must be between {low:g} and {high:g}")
    return found


def setting(
    name: str, values: Found, known: dict[str, Any], frames: str
) -> dict[str, Any]:
    """Return an effect of the profile, its parameters within the registry's bounds."""
    parameters, intervals = {}, {}
    for parameter in known["parameters"]:
        key = parameter["name"]
        if parameter["optional"] and key not in values:
            continue
        given = values.get(key, parameter["null"])
        if isinstance(given, Measured):
            value, half = given.value, CI95 * given.standard_error
            if half > 0:
                intervals[key] = [rounded(value - half), rounded(value + half)]
            given = value
        bounded = np.clip(given, parameter["min"], parameter["max"])
        parameters[key] = rounded(float(bounded))
    return {
        "name": name,
        "parameters": parameters,
        "ci95": intervals,
        "evidence": {"found_by": "cg2raw calibrate", "frames": frames},
    }


def rounded(value: float) -> float:
    """Return a number with as many digits as a measurement has at most."""
    return float(f"{value:.{DIGITS}g}")
