# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Updated profile: a sensor with what was measured in place of what it had."""

import json
from contextlib import suppress
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.profile_effects import Found, effects_found, tails
from cg2raw.io.json_text import formatted
from cg2raw.sensor import Sensor

SOURCE = "cg2raw calibrate (EMVA 1288 R4.0)"
NORMAL = 0.14  # Tukey's lambda of an almost normal distribution
DIGITS = 6  # significant, of numbers in the profile
CI95 = 1.96  # standard errors


def updated_profile(found: Measurements, sensor: Sensor) -> tuple[str, list[str]]:
    """Return (JSON of a sensor's profile with what was measured, notes)."""
    profile = json.loads(sensor.to_json())
    known = {effect["name"]: effect for effect in _core.effects()}
    effects, notes = effects_found(found, has_shapes(profile)), tails(found)
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


def add_noise(
    profile: dict[str, Any], found: Measurements, sensor: Sensor, source: str
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
        row = {**before, **row, **shape_of(found, before)}
        row["beta2"] = [rounded(b + row["row_sigma"] ** 2) for b in row["beta2"]]
    old[found.iso] = row
    profile["noise"] = [old[iso] for iso in sorted(old)]
    profile["sources"]["noise"] = f"ISO {found.iso:g}: {source}" + (
        f"; other ISOs: {profile['sources'].get('noise', 'as before')}"
        if len(old) > 1 and SOURCE not in profile["sources"].get("noise", "")
        else ""
    )
    return []


def betas_of(found: Measurements, sensor: Sensor) -> dict[str, list[float]]:
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


def shape_of(found: Measurements, before: dict[str, Any]) -> dict[str, float]:
    """Return how a row of noise says that it is distributed."""
    if found.tails is None:
        return {name: before[name] for name in ("tukey_lambda", "row_sigma")}
    shape, rows = found.tails.tukey_lambda, found.figure("row noise")
    return {
        "tukey_lambda": rounded(NORMAL if shape is None else shape),
        "row_sigma": rounded((rows.value if rows else 0.0) / found.range),
    }


def bounds_passed(values: Found, known: dict[str, Any]) -> list[str]:
    """Return sentences on measured parameters that are at a bound of the registry, as a
    search ends there, or beyond it by more than their error."""
    found = []
    for parameter in known["parameters"]:
        given = values.get(parameter["name"])
        low, high = parameter["min"], parameter["max"]
        if not isinstance(given, Measured):
            continue
        value, half = given.value, CI95 * given.standard_error
        within = value not in (low, high) and low - half < value < high + half
        if not (within or low < value < high):
            name = parameter["name"]
            found.append(f"{name} is {value:.4g}; must be between {low:g} and {high:g}")
    return found


def setting(
    name: str, values: Found, known: dict[str, Any], frames: str
) -> dict[str, Any]:
    """Return an effect of the profile, its parameters within the registry's bounds."""
    parameters, intervals = {}, {}
    for parameter in known["parameters"]:
        if parameter["optional"] and parameter["name"] not in values:
            continue
        low, high = parameter["min"], parameter["max"]
        given = values.get(parameter["name"], parameter["null"])
        if isinstance(given, Measured):
            if (half := CI95 * given.standard_error) > 0:
                ends = given.value - half, given.value + half
                intervals[parameter["name"]] = [rounded(end) for end in ends]
            given = given.value
        parameters[parameter["name"]] = rounded(min(max(float(given), low), high))
    return {
        "name": name,
        "parameters": parameters,
        "ci95": intervals,
        "evidence": {"found_by": "cg2raw calibrate", "frames": frames},
    }


def rounded(value: float) -> float:
    """Return a number with as many digits as a measurement has at most."""
    return float(f"{value:.{DIGITS}g}")
