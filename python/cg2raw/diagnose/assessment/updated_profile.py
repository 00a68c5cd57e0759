# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Updated profile: the sensor with the found effects added, and what told of them."""

import json
from collections.abc import Sequence
from typing import Any

from cg2raw.diagnose.diagnosis import Finding
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.model_profile import model_profile
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.sensor import Sensor


def updated_profile(
    model: Model,
    frames: Sequence[Frame],
    findings: Sequence[Finding],
    estimates: EstimatesByEffect,
) -> str:
    """Return the JSON of the baseline's profile with a model's effects in it."""
    profile = model_profile(model, frames, estimates)
    found = {term.name for term in model.terms if not term.calibration}
    for effect in profile.get("effects", []):
        name = effect["name"]
        if name in found:
            of_effect = estimates[name].items()
            effect["ci95"] = {n: list(each.ci95) for n, each in of_effect}
            effect["evidence"] = _evidence(name, findings, frames)
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
