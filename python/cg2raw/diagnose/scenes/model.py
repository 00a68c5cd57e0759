# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Model: a sensor and effects on top of it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values
from cg2raw.diagnose.effects.registry import stated_by
from cg2raw.sensor import Sensor

SENSORS_KNOWN = 8  # whose parameters are at hand


@dataclass(frozen=True)
class Term:
    """One effect of a model and its values.

    calibration : it is fitted with all others, and is no finding: nobody had said what
        its value should be."""

    effect: Effect
    values: Values
    calibration: bool = False

    @property
    def name(self) -> str:
        return self.effect.name


@dataclass(frozen=True)
class Model:
    """Effects on top of the baseline sensor."""

    sensor: Sensor
    terms: tuple[Term, ...] = ()

    def term(self, name: str) -> Term | None:
        return next((term for term in self.terms if term.name == name), None)

    def with_term(self, term: Term) -> "Model":
        """Return the model with a term added, or in the place of its namesake."""
        terms = {t.name: t for t in self.terms} | {term.name: term}
        return replace(self, terms=tuple(terms.values()))

    def with_effect(self, effect: Effect, values: Values) -> "Model":
        """Return the model with an effect at values."""
        return self.with_term(Term(effect, np.asarray(values, float)))

    def without(self, name: str) -> "Model":
        return replace(self, terms=tuple(t for t in self.terms if t.name != name))

    def noise_gain(self, betas: str) -> float:
        """Return what multiplies betas of the noise model."""
        logs = [float(t.values[0]) for t in self.terms if t.effect.scales == betas]
        return float(np.exp(sum(logs)))

    @property
    def profile_parameters(self) -> Mapping[str, Mapping[str, float]]:
        """Parameters of the effects that the sensor's profile has, in the order of the
        registry."""
        return _parameters_of(self.sensor)


@lru_cache(maxsize=SENSORS_KNOWN)
def _parameters_of(sensor: Sensor) -> Mapping[str, Mapping[str, float]]:
    return {
        entry["name"]: stated_by(entry, sensor.cfa) for entry in sensor.effects or ()
    }
