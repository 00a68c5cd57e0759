# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Updated profile: the sensor with the found effects added."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from cg2raw.cfa import sites_of
from cg2raw.diagnose.diagnosis import Finding
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.sensor import Sensor


def updated_profile(
    model: Model,
    frames: Sequence[Frame],
    findings: Sequence[Finding],
    estimates: EstimatesByEffect,
) -> str:
    """Return the JSON of the baseline's profile with a model's effects in it."""
    profile = json.loads(model.sensor.to_json())
    _add_estimated_noise(profile, frames)
    effects = {effect["name"]: effect for effect in profile.get("effects", [])}
    listed = model.profile_parameters
    for term in model.terms:
        effect = term.effect
        if effect.change_noise_table(profile, term.values) or term.calibration:
            continue
        # What moves the prediction was fitted on top of the profile's, all else whole.
        old = listed.get(term.name, {}) if effect.predicted else {}
        found = effect.registry_estimates(estimates[term.name], term.sensor_map)
        values = np.array([estimate.value for estimate in found.values()])
        if old:
            values = effect.added(np.array([old[name] for name in found]), values)
        bounded = effect.within_registry_bounds(values)
        effects[term.name] = {
            "name": term.name,
            "parameters": dict(zip(found, map(float, bounded), strict=True)),
            "ci95": {n: list(e.ci95) for n, e in estimates[term.name].items()},
            "evidence": _evidence(term.name, findings, frames),
        }
    if effects:
        profile["effects"] = list(effects.values())
    text = json.dumps(profile, indent=2)
    return Sensor.from_json(text, "the updated profile").profile.to_json()


def _evidence(
    name: str, findings: Sequence[Finding], frames: Sequence[Frame]
) -> dict[str, Any]:
    gains = {finding.name: finding.gain_nats for finding in findings}
    return {
        "found_by": "cg2raw diagnose",
        "gain_nats": round(gains.get(name, 0.0), 3),
        "captures": sorted({frame.capture.name for frame in frames}),
    }


def _add_estimated_noise(profile: dict[str, Any], frames: Sequence[Frame]) -> None:
    """A profile without noise takes what was measured of the captures."""
    if profile.get("noise"):
        return
    rows = {}
    for frame in frames:
        iso = frame.capture.iso
        if iso is not None and not frame.noise.measured:
            sites = len(sites_of(profile["cfa"]))
            rows[iso] = {
                "iso": iso,
                "beta1": _for_profile(frame.noise.beta1, sites),
                "beta2": _for_profile(frame.noise.beta2, sites),
            }
    if rows:
        profile["noise"] = [rows[iso] for iso in sorted(rows)]


def _for_profile(betas: Sequence[float], sites: int) -> list[float]:
    return list(betas) if len(betas) > 1 else [betas[0]] * sites
