# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Models, and what they predict of a frame."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.diagnose.effects.catalogue import Candidate, Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array

LEAST_VARIANCE = 1e-12
BAYER = 4  # sites of its repeat


@dataclass(frozen=True)
class Pattern:
    """A fixed map of the sensor as the fit frames tell it: mean and variance, on the
    tiles; `bearing` says what it multiplies (see fixed_patterns)."""

    mean: Array
    variance: Array

    @property
    def spread(self) -> float:
        """Standard deviation of the map where it is not known."""
        return float(np.sqrt(np.mean(self.mean**2 + self.variance)))


@dataclass(frozen=True)
class Term:
    """One effect of a model and its values; a pattern has its map besides.

    calibration : it is fitted with all others, and is no finding: nobody had said what
        its value should be."""

    candidate: Candidate
    values: Values
    pattern: Pattern | None = None
    calibration: bool = False

    @property
    def name(self) -> str:
        return self.candidate.name


@dataclass(frozen=True)
class Model:
    """Effects on top of the doubted sensor; nuisances are of the capture alone."""

    sensor: Any
    terms: tuple[Term, ...] = ()
    nuisance: Any = None

    @property
    def names(self) -> list[str]:
        return [term.name for term in self.terms]

    @property
    def found_names(self) -> list[str]:
        """Names of the terms that are findings."""
        return [term.name for term in self.terms if not term.calibration]

    def term(self, name: str) -> Term | None:
        return next((term for term in self.terms if term.name == name), None)

    def with_term(self, term: Term) -> "Model":
        """Return the model with a term added, or in the place of its namesake."""
        if self.term(term.name) is None:
            return replace(self, terms=(*self.terms, term))
        terms = tuple(term if t.name == term.name else t for t in self.terms)
        return replace(self, terms=terms)

    def with_values(self, name: str, values: Values) -> "Model":
        term = self.term(name)
        assert term is not None
        return self.with_term(replace(term, values=values))

    def without(self, name: str) -> "Model":
        return replace(self, terms=tuple(t for t in self.terms if t.name != name))


@dataclass(frozen=True)
class Prediction:
    """Mean and variance over frames of every pixel, (T, h, w), signal units.

    exposed : the mean before noise; photons, and variance of the photons.
    light_variance : of light that nobody measured, part of the variance."""

    mean: Array
    variance: Array
    exposed: Array
    photon_variance: Array
    light_variance: Array | float = 0.0


def registry_values(model: Model, frame: Frame) -> list[tuple[str, list[float]]]:
    """Return all effects that the registry simulates for a model, with values.

    Its noises have one parameter per site of a Bayer CFA; `predict` adds those of
    others."""
    profile = {
        effect["name"]: list(effect["parameters"].values())
        for effect in ordered_effects(model.sensor)
        if effect["name"] not in _FLOWS and effect["name"] not in PATTERNS
    }
    for term in model.terms:
        name = term.name
        if term.candidate.way == "smooth" and name not in _NOISE or name in _OUTPUT:
            old = np.array(profile.get(name, term.candidate.null))
            profile[name] = within_bounds(name, old + term.values).tolist()
    sites = len(model.sensor.cfa)
    if sites != BAYER:
        return list(profile.items())
    gain, excess = (np.exp(_value(model, name)) for name in _NOISE)
    for name, betas, factor in (
        ("shot_noise", frame.noise.beta1, gain),
        ("read_noise", frame.noise.beta2, excess),
    ):
        spread = betas if len(betas) > 1 else betas * sites
        profile[name] = [min(factor * beta, 1.0) for beta in spread]
    return list(profile.items())


def flow_values(model: Model, frame: Frame, name: str) -> Values | None:
    """Return the values of a flow: a term's, or what the profile has; None if neither.

    A term's clipping and noise reduction come on top of the profile's, as they do in
    registry_values."""
    term = model.term(name)
    if name not in _ADDED:
        drawn = frame.noise.drawn.get(name)
        given = None if drawn is None else np.array(drawn)
        return given if term is None else term.values
    listed = {e["name"]: e["parameters"] for e in ordered_effects(model.sensor)}
    given = np.array(list(listed[name].values()), float) if name in listed else None
    if term is None or given is None:
        return given if term is None else term.values
    return given + term.values


def within_bounds(name: str, values: Values) -> Values:
    """Return values of an effect within the bounds of the registry: a found value and
    the profile's are each within them, and their sum need not be."""
    low, high = _bounds()[name]
    return np.clip(values, low, high)


@cache
def _bounds() -> Mapping[str, tuple[Values, Values]]:
    return {
        effect["name"]: (
            np.array([p["min"] for p in effect["parameters"]], float),
            np.array([p["max"] for p in effect["parameters"]], float),
        )
        for effect in _core.effects()
    }


_NOISE = ("shot_noise", "read_noise")
_FLOWS = ("row_noise",)
# The registry draws its own map of these, and no sensor has that one.
PATTERNS = ("prnu", "dsnu", "column_noise", "hot_pixels")
_ADDED = ("early_clipping", "noise_reduction")
_OUTPUT = ("noise_reduction",)


def ordered_effects(sensor: Any) -> list[dict[str, Any]]:
    """Return the effects of a profile with parameters in the registry's order."""
    if not sensor.effects:
        return []
    return [
        {
            **effect,
            "parameters": {
                n: effect["parameters"][n] for n in _order()[effect["name"]]
            },
        }
        for effect in sensor.effects
    ]


@cache
def _order() -> Mapping[str, list[str]]:
    return {e["name"]: [p["name"] for p in e["parameters"]] for e in _core.effects()}


def _value(model: Model, name: str) -> float:
    term = model.term(name)
    return 0.0 if term is None else float(term.values[0])


def predict(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame: effects by the registry, then maps."""
    mean, variance, exposed = (
        part.astype(float)
        for part in _core.predict_blocks(
            model.sensor._profile,
            registry_values(model, frame),
            frame.camera,
            frame.tiles.origins,
            frame.tiles.shape,
            frame.tiles.margin,
            frame.neutral,
            frame.seconds,
            frame.surround,
        )
    )
    photons = np.maximum(exposed, 0)
    photon_variance = photon_gain(model, frame) * photons
    if len(model.sensor.cfa) != BAYER:
        read_variance = np.exp(_value(model, "read_noise")) * frame.beta2
        variance = variance + photon_variance + read_variance
    sign = -1.0 if frame.capture.group == "fit" else 1.0
    doubt = 0.0
    for term in model.terms:
        if term.pattern is None:
            continue
        bearing = pattern_bearing(term.name, frame, photons)
        if term.pattern.mean.shape != mean.shape:  # elsewhere the map is not known
            variance = variance + (bearing * term.pattern.spread) ** 2
        else:
            shift = bearing * term.pattern.mean
            mean = mean + shift
            unsure = bearing**2 * term.pattern.variance
            if term.name == "hot_pixels":  # charge, with the shot noise of charge
                variance = variance + photon_gain(model, frame) * np.maximum(shift, 0)
                if sign > 0:
                    variance = variance + unsure
            else:
                doubt = doubt + unsure
    # The fit frames made the map: their residuals are too small by its variance. Of a
    # hot pixel it is mostly not known whether it is one, which makes nothing smaller.
    variance = np.maximum(variance + sign * doubt, 0.15 * variance)
    variance = np.maximum(variance, LEAST_VARIANCE) + 1 / 12 / frame.range**2
    unknown: Array | float = 0.0
    if model.nuisance is not None:
        unknown = model.nuisance.pixel_variance(frame, variance)
    return Prediction(mean, variance + unknown, exposed, photon_variance, unknown)


def photon_gain(model: Model, frame: Frame) -> Array:
    """Return the variance of light per signal, (h, w)."""
    return np.exp(_value(model, "shot_noise")) * frame.beta1


def pattern_bearing(name: str, frame: Frame, photons: Array) -> Any:
    """Return what a pattern's map is multiplied by in a frame."""
    if name == "prnu":
        return photons
    return frame.seconds if name == "hot_pixels" else 1.0


def place(model: Model, candidate: Candidate, values: Values | None = None) -> Model:
    """Return the model with a candidate at its null, or at given values."""
    start = candidate.null if values is None else np.asarray(values, float)
    return model.with_term(Term(candidate, start))
