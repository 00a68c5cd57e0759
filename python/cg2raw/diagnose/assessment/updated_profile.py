# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The sensor with the found effects added, as a profile that simulates them."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.diagnose.diagnosis import Estimate, Finding
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.prediction import (
    PATTERNS,
    Model,
    Term,
    ordered_effects,
    within_bounds,
)
from cg2raw.sensor import Sensor

NORMAL_LAMBDA = 0.14  # Tukey's lambda that is nearest to a normal


def found_profile(
    model: Model,
    frames: Sequence[Frame],
    findings: Sequence[Finding],
    estimates: Mapping[str, Mapping[str, Estimate]],
) -> str:
    """Return the JSON of the doubted profile with a model's effects in it."""
    profile = json.loads(model.sensor.to_json())
    _add_estimated_noise(profile, frames)
    effects = {effect["name"]: effect for effect in profile.get("effects", [])}
    order = {e["name"]: e["parameters"] for e in ordered_effects(model.sensor)}
    for term in model.terms:
        if _changed_table(profile, term) or term.calibration:
            continue
        # Patterns and rows were fitted whole, and all else on top of the profile's.
        whole = term.name in PATTERNS or term.name == "row_noise"
        old = {} if whole else order.get(term.name, {})
        found = _of_registry(term, estimates, frames)
        sums = [found[name].value + old.get(name, 0.0) for name in found]
        bounded = within_bounds(term.name, np.array(sums))
        parameters = dict(zip(found, map(float, bounded), strict=True))
        effects[term.name] = {
            "name": term.name,
            "parameters": parameters,
            "ci95": {n: list(e.ci95) for n, e in estimates[term.name].items()},
            "evidence": _evidence(term.name, findings, frames),
        }
    if effects:
        profile["effects"] = list(effects.values())
    text = json.dumps(profile, indent=2)
    return Sensor.from_json(text, "the found profile").to_json()


def _evidence(
    name: str, findings: Sequence[Finding], frames: Sequence[Frame]
) -> dict[str, Any]:
    gains = {finding.name: finding.gain_nats for finding in findings}
    return {
        "found_by": "cg2raw diagnose",
        "gain_nats": round(gains.get(name, 0.0), 3),
        "captures": sorted({frame.capture.name for frame in frames}),
    }


def _of_registry(
    term: Term, estimates: Mapping[str, Mapping[str, Estimate]], frames: Sequence[Frame]
) -> Mapping[str, Estimate]:
    """Return the parameters that the registry simulates a term by."""
    if term.name != "hot_pixels":
        return estimates[term.name]
    assert term.pattern is not None
    hot = term.pattern.mean[term.pattern.mean > 0]
    rate = float(hot.mean()) if hot.size else 0.0
    return {**estimates[term.name], "rate": Estimate(rate, "1/s", (rate, rate))}


def _add_estimated_noise(profile: dict[str, Any], frames: Sequence[Frame]) -> None:
    """A profile without noise takes what was measured of the captures."""
    if profile.get("noise"):
        return
    rows = {}
    for frame in frames:
        iso = frame.capture.iso
        if iso is not None and not frame.noise.measured:
            sites = len(profile["cfa"])
            rows[iso] = {
                "iso": iso,
                "beta1": _for_profile(frame.noise.beta1, sites),
                "beta2": _for_profile(frame.noise.beta2, sites),
            }
    if rows:
        profile["noise"] = [rows[iso] for iso in sorted(rows)]


def _for_profile(betas: Sequence[float], sites: int) -> Any:
    return list(betas) if len(betas) > 1 else [betas[0]] * sites


def _changed_table(profile: dict[str, Any], term: Term) -> bool:
    """Write a term into the profile's noise table, if that is its place."""
    rows = profile.get("noise", [])
    if term.name in ("shot_noise", "read_noise"):
        key = "beta1" if term.name == "shot_noise" else "beta2"
        factor = float(np.exp(term.values[0]))
        for row in rows:
            row[key] = _scaled(row[key], factor)
        return True
    if term.name not in ("photon_statistics", "heavy_tailed_noise"):
        return False
    drawn = profile.setdefault("noise_effects", ["shot_noise", "read_noise"])
    old = "shot_noise" if term.name == "photon_statistics" else "read_noise"
    profile["noise_effects"] = [term.name if name == old else name for name in drawn]
    if term.name == "heavy_tailed_noise":
        for row in rows:
            row["tukey_lambda"] = NORMAL_LAMBDA
            row["row_sigma"] = 0.0
            row["outlier_fraction"] = float(term.values[0])
            row["outlier_variance_ratio"] = float(term.values[1])
    return True


def _scaled(beta: Any, factor: float) -> Any:
    return [b * factor for b in beta] if isinstance(beta, list) else beta * factor
