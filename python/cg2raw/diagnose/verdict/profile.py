# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The profile of a sensor with effects that were named."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.diagnose.diagnosis import Finding
from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.effects.registry import listed_parameters, registered
from cg2raw.sensor import Sensor

# Effects whose values are of the sensor itself; all others' are beyond the profile's.
OF_SENSOR = frozenset(
    {
        *("black_level_drift", "row_noise", "dsnu", "column_fixed_pattern", "prnu"),
        *("dark_current", "dark_current_nonuniformity", "hot_pixels", "dust"),
        *("random_telegraph_noise", "pdaf_pixels", "mains_flicker"),
        *("read_noise_correlation", "noise_reduction"),
        *("bias_structure", "amplifier_glow", "amplifier_mismatch"),
    }
)


def updated_profile(
    sensor: Sensor,
    findings: Sequence[Finding],
    captures: Sequence[str],
    noise: dict[str, Any] | None = None,
    edge: float = 0.0,
) -> str:
    """Return the JSON of a sensor's profile with what was found in it.

    captures : names of the frames that tell the values. noise : a row for a profile
    without any at its ISO. edge : mean_of_edge, which the black level is beside. Raises
    ValueError where the values are none of a profile."""
    profile: dict[str, Any] = json.loads(sensor.to_json())
    if noise is not None:
        rows = [*profile.get("noise", []), noise]
        profile["noise"] = sorted(rows, key=lambda row: row["iso"])
    entries = {entry["name"]: entry for entry in profile.get("effects", [])}
    for finding in findings:
        if not finding.parameters:
            continue
        values = {name: one.value for name, one in finding.parameters.items()}
        if finding.name == "black_level":  # the edge is an effect itself
            values = {name: value - edge for name, value in values.items()}
        known = effect(finding.name)
        if known.change_noise_table(profile, np.array(list(values.values()))):
            continue
        entries[finding.name] = {
            "name": finding.name,
            "parameters": _bounded(sensor, finding.name, values),
            "ci95": {n: list(one.ci95) for n, one in finding.parameters.items()},
            "evidence": {
                "found_by": "cg2raw diagnose",
                "gain_nats": round(finding.gain_nats, 3),
                "captures": sorted(captures),
            },
        }
    if entries:
        profile["effects"] = list(entries.values())
    text = json.dumps(profile, indent=2)
    return Sensor.from_json(text, "the updated profile").profile.to_json()


def mean_of_edge(findings: Sequence[Finding], width: int) -> float:
    """Return what the first columns of a bias structure add to the mean of all, width
    px wide."""
    for finding in findings:
        if finding.name == "bias_structure" and "edge" in finding.parameters:
            height, length = (
                finding.parameters[name].value for name in ("edge", "edge_length")
            )
            return height * float(np.exp(-np.arange(width) / length).mean())
    return 0.0


def _bounded(
    sensor: Sensor, name: str, values: Mapping[str, float]
) -> dict[str, float]:
    """Return all parameters of an effect, within the bounds of the registry."""
    listed = listed_parameters(sensor, name) or {}
    found = {}
    for known in registered(sensor.cfa)[name]["parameters"]:
        key, null = known["name"], float(known["null"])
        old = listed.get(key, null)
        if key not in values:
            if known["optional"] and key not in listed:
                continue
            value = old
        else:
            value = values[key] if name in OF_SENSOR else old + values[key] - null
        found[key] = float(np.clip(value, known["min"], known["max"]))
    return found
