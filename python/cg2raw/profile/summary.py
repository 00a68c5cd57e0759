# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor profile summed up in JSON's types, for reports and lists."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.cfa import sites_of

LEAST_CCT, MOST_CCT = 1e6 / 600, 1e6 / 10  # K, where Robertson's table ends
STOP = 2.0  # noise is interpolated up to one stop beyond the calibrated ISOs


def summary(profile: _core.SensorProfile) -> dict[str, Any]:
    """Return what people ask of a SensorProfile, as a dictionary.

    Units: DN, K, (R/G, B/G); noise x in 0..1 above black."""
    return {
        **{name: plain(getattr(profile, name)) for name, _ in _core.profile_fields},
        "camera": _core.camera_name(profile.make, profile.model),
        "illuminants": illuminants_of(profile),
        "noise": {**noise_of(profile.noise), "effects": profile.noise_effects},
        "sources": dict(profile.sources),
    }


def plain(value: Any) -> Any:
    """Return a value in JSON's types: lists in the place of tuples and arrays."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {name: plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    return value


def illuminants_of(profile: _core.SensorProfile) -> dict[str, Any]:
    """Return the distribution of neutrals, their number and their range in K.

    cct is [lowest, highest] of neutrals or hull, None if there are neither. It bounds
    the neutrals, not quite what may be drawn between them."""
    lights = profile.illuminants
    points = lights["neutrals"] or lights["hull"]
    kelvins = [profile.illuminant(f"neutral:{r!r}:{b!r}").cct for r, b in points]
    known = bool(points)
    return {
        "count": len(lights["neutrals"]),
        "mean": list(lights["mean"]) if known else None,
        "sd": [float(v) ** 0.5 for v in lights["covariance"].diagonal()]
        if known
        else None,
        "covariance": lights["covariance"].tolist() if known else None,
        "hull": [list(point) for point in lights["hull"]],
        "neutrals": [list(point) for point in lights["neutrals"]],
        "cct": [min(kelvins), max(kelvins)] if known else None,
    }


def noise_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the calibrated rows and the ISOs between which noise can be simulated."""
    isos = [row["iso"] for row in rows]
    reach = STOP if len(isos) > 1 else 1.0
    return {
        "rows": rows,
        "iso": [isos[0], isos[-1]] if isos else None,
        "iso_usable": [isos[0] / reach, isos[-1] * reach] if isos else None,
    }


def cfa_word(cfa: str) -> str:
    """Return a CFA's name for people: the four letters of Bayer, X-Trans, or mono."""
    sites = len(sites_of(cfa))
    return {1: "mono", 4: cfa, 36: "X-Trans"}.get(sites, f"{sites} sites")


def kelvin_words(cct: Sequence[float] | None) -> str:
    """Return "2700-7500 K", one temperature if they are alike, "-" for None.

    Where one is beyond Robertson's table: "below 1667 to 3630 K"."""
    if cct is None:
        return "-"
    low, high = (kelvin_word(kelvin) for kelvin in cct)
    between = " to " if " " in low + high else "-"
    return f"{low} K" if low == high else f"{low}{between}{high} K"


def kelvin_word(kelvin: float) -> str:
    """Return one temperature; that it is below or above Robertson's table."""
    beyond = "below " * (kelvin <= LEAST_CCT) + "above " * (kelvin >= MOST_CCT)
    return f"{beyond}{kelvin:.0f}"


def neutral_words(lights: Mapping[str, Any]) -> str:
    """Return number, range, mean and standard deviation of the neutrals."""
    if not lights["mean"]:
        return "none"
    (red, blue), (sd_red, sd_blue) = lights["mean"], lights["sd"]
    spread = (
        f", R/G {red:.4f} sd {sd_red:.4f}, B/G {blue:.4f} sd {sd_blue:.4f}"
        if lights["count"] != 1
        else f", R/G {red:.4f}, B/G {blue:.4f}"
    )
    count = lights["count"] or f"hull of {len(lights['hull'])} corners"
    return f"{count}, {kelvin_words(lights['cct'])}{spread}"


def iso_words(noise: Mapping[str, Any]) -> str:
    """Return "100-3200 (50-6400)": ISOs calibrated, and those that can be simulated."""
    if not noise["iso"]:
        return "no noise"
    low, high = (f"{iso:g}" for iso in noise["iso"])
    if low == high:
        return f"{low} only"
    return f"{low}-{high} ({'-'.join(f'{iso:g}' for iso in noise['iso_usable'])})"
