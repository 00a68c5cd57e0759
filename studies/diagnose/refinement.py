# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Refinement: the profile of a calibration, its fixed patterns as strong as the search
engine finds them likeliest, all together: that profile it does not contradict."""

import json
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.calibration import Calibration, Measured, UniformFrame
from cg2raw.calibration.updated_profile import setting
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.reader import LIGHT_OF_DARKS, dark
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import NORMAL_95, Effect
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.reader import read_frames
from cg2raw.diagnose.inference.baseline import Baseline, baseline_of
from cg2raw.diagnose.inference.calibrated_start import calibrated_start, settled
from cg2raw.diagnose.inference.contradictions import as_finding
from cg2raw.diagnose.inference.illumination import SHADING
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.workers import Workers
from cg2raw.sensor import Sensor


def refined(found: Calibration, frames: Sequence[UniformFrame]) -> Sensor:
    """Return the calibrated sensor with the likeliest strengths of the fixed patterns
    that its profile has. frames : that were calibrated."""
    text = found.updated_profile()
    sensor = Sensor.from_json(text, f"{found.sensor.id}, calibrated")
    patterns = _stated_patterns(sensor)
    if not patterns or found.iso is None:
        return sensor
    used = [one for one in frames if one.name not in found.excluded]
    counting = found.defects.counting
    captures = CaptureSet(
        sensor, [capture_of(one, found.shape, counting) for one in used]
    )
    shown = read_frames(captures, noise_models(captures), None, _silent)
    splits = Splits(shown, Workers(1, None))
    model = freely_mapped(baseline_of(captures, splits, _silent), patterns)
    if model is None:
        return sensor
    known = {effect["name"]: effect for effect in _core.effects()}
    profile = json.loads(text)
    laws = _laws(model)
    profile["effects"] = [
        setting(name, laws[name], known[name], "the frames that were calibrated")
        if (name := effect["name"]) in laws
        else effect
        for effect in profile["effects"]
    ]
    return Sensor.from_json(json.dumps(profile), f"{found.sensor.id}, calibrated")


def freely_mapped(baseline: Baseline, effects: Sequence[Effect]) -> Model | None:
    """Return the profile with its maps as strong as its frames show them, whatever it
    says of that; None where there are none."""
    start = calibrated_start(baseline, effects)
    if start is None:
        return None
    model = start.model
    for term, _, _ in start.model.maps:
        model = as_finding(model, term.name)
    return settled(model, start.splits.fit)


def _silent(words: str, share: float) -> None:
    """Report nothing."""


def _stated_patterns(sensor: Sensor) -> list[Effect]:
    """Return the fixed patterns of a profile, and shading, which flats have beside its
    own."""
    listed = {effect["name"] for effect in sensor.effects or ()}
    known = candidates(sensor.cfa)
    patterns = [e for e in known if isinstance(e, FixedPattern) and e.name in listed]
    return [*patterns, *(e for e in known if e.name == SHADING)] if patterns else []


def capture_of(
    one: UniformFrame, shape: tuple[int, int], counting: NDArray[np.bool_] | None = None
) -> Capture:
    """Return a frame as a capture of the fit; light is not known of any.

    counting : (H, W) bool, pixels that count; None for all."""
    return Capture(
        name=one.name,
        kind=one.kind,
        shape=shape,
        group="fit",
        set=one.name,
        illuminant=LIGHT_OF_DARKS,
        iso=one.iso,
        exposure_time=one.exposure_time,
        raw=one.pixels,
        scene=dark if one.kind == "dark" else None,
        temperature=one.temperature,
        mask=None if counting is None else lambda: counting,
    )


def _laws(model: Model) -> dict[str, Mapping[str, Measured]]:
    """Return the parameters of a model's maps, as a profile says them."""
    found: dict[str, Mapping[str, Measured]] = {}
    for term, effect, known in model.maps:
        errors = effect.standard_errors(term.values, known)
        values = {
            name: _estimate(float(value), NORMAL_95 * error, unit)
            for name, value, error, unit in zip(
                effect.parameters, term.values, errors, effect.units, strict=True
            )
        }
        law = effect.registry_estimates(values, known)
        found[term.name] = {name: _measured(one) for name, one in law.items()}
    return found


def _estimate(value: float, half: float, unit: str) -> Estimate:
    return Estimate(value, unit, (value - half, value + half))


def _measured(one: Estimate) -> Measured:
    low, high = one.ci95
    return Measured(one.value, (high - low) / (2 * NORMAL_95), one.unit)
