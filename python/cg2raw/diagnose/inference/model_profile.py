# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Model profile: a sensor with a model's effects in it, as the registry draws them."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from cg2raw.cfa import sites_of
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.effects.sizes import value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.model import Model


def model_profile(
    model: Model, frames: Sequence[Frame], estimates: EstimatesByEffect
) -> dict[str, Any]:
    """Return the JSON object of the baseline's profile with a model's effects in it,
    but those that calibrate it: of these the profile says how strong they are."""
    profile: dict[str, Any] = json.loads(model.sensor.to_json())
    _add_estimated_noise(profile, frames)
    effects = {effect["name"]: effect for effect in profile.get("effects", [])}
    listed = model.profile_parameters
    for name, entry in effects.items():
        entry["parameters"] = {p: listed[name][p] for p in entry["parameters"]}
    for term in model.terms:
        effect = term.effect
        if effect.change_noise_table(profile, term.values) or term.calibration:
            continue
        # What moves the prediction was fitted on top of the profile's, all else whole.
        old = listed.get(term.name, {}) if effect.predicted else {}
        found = estimates[term.name]
        names = effect.registry_parameters
        values = np.array([value_of(found, name) for name in names])
        if old:
            values = effect.added(np.array(list(old.values())), values)
        bounded = zip(names, effect.within_registry_bounds(values), strict=True)
        parameters = {n: float(value) for n, value in bounded if value or n in found}
        effects[term.name] = {"name": term.name, "parameters": parameters}
    if effects:
        profile["effects"] = list(effects.values())
    return profile


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
