# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Model: a sensor, effects on top of it, and what is wrong with the captures alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from cg2raw.diagnose.effects.base import Effect, SensorMap, Values
from cg2raw.diagnose.effects.dark_current import DARK_CURRENT, RATES, ratio_to_stated
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.rate_law import RateLaw
from cg2raw.diagnose.effects.registry import stated_by
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Mask
from cg2raw.diagnose.likelihood.nuisance import Nuisance
from cg2raw.sensor import Sensor

SENSORS_KNOWN = 8  # whose parameters are at hand


@dataclass(frozen=True)
class Term:
    """One effect of a model and its values; a fixed pattern has its map besides.

    calibration : it is fitted with all others, and is no finding: nobody had said what
        its value should be.
    held : of a fixed pattern: it is as strong as the profile says, whatever its pixels.
    contradicted : nats that the frames of its map lose by what the profile says of its
        strength, where that was given up."""

    effect: Effect
    values: Values
    sensor_map: SensorMap | None = None
    calibration: bool = False
    held: bool = False
    contradicted: float = 0.0

    @property
    def name(self) -> str:
        return self.effect.name

    def map_of(self, shape: tuple[int, ...]) -> SensorMap | None:
        """Return its map, if that is of tiles (T, h, w) of a shape."""
        known = self.sensor_map
        return known if known is not None and known.mean.shape == shape else None


@dataclass(frozen=True)
class Model:
    """Effects on top of the baseline sensor; nuisances are of the captures alone.

    by_temperature : dark current that was found is that of another temperature, with
        which all charge that the profile says goes that gathers without light."""

    sensor: Sensor
    terms: tuple[Term, ...] = ()
    nuisance: Nuisance | None = None
    by_temperature: bool = False

    @property
    def names(self) -> list[str]:
        return [term.name for term in self.terms]

    @property
    def found_names(self) -> list[str]:
        """Names of the terms that are findings."""
        return [term.name for term in self.terms if not term.calibration]

    @property
    def maps(self) -> Iterator[tuple[Term, FixedPattern, SensorMap]]:
        """Fixed patterns whose map is known."""
        for term in self.terms:
            if term.sensor_map is not None and isinstance(term.effect, FixedPattern):
                yield term, term.effect, term.sensor_map

    def map_on(self, effect: Effect, frame: Frame) -> SensorMap | None:
        """Return the map of an effect; None where it is not known of a frame's
        tiles."""
        term = self.term(effect.name)
        if term is None or term.sensor_map is None:
            return None
        known = term.map_of(frame.signal.shape)
        return _anywhere(term.sensor_map) if known is None else known

    def rate_law_on(self, frame: Frame) -> tuple[Mask, RateLaw] | None:
        """Return (where maps do not say how fast charge gathers, how fast it does by
        their laws) for laws of long tails; None if there are no such pixels."""
        found = [
            (known.unknown, known.rate_law)
            for _, effect, known in sorted(
                self.maps, key=lambda one: one[1].layout == "sparse"
            )
            if known.unknown is not None
            and known.rate_law is not None
            and known.unknown.shape == frame.signal.shape
            and known.unknown.any()
        ]
        if not found:
            return None
        unknown, laws = zip(*found, strict=True)
        return np.logical_or.reduce(unknown), RateLaw.together(laws)

    def term(self, name: str) -> Term | None:
        return next((term for term in self.terms if term.name == name), None)

    def with_term(self, term: Term) -> "Model":
        """Return the model with a term added, or in the place of its namesake."""
        if self.term(term.name) is None:
            return replace(self, terms=(*self.terms, term))
        terms = tuple(term if t.name == term.name else t for t in self.terms)
        return replace(self, terms=terms)

    def with_effect(self, effect: Effect, values: Values | None = None) -> "Model":
        """Return the model with an effect at its null, or at given values."""
        start = effect.null if values is None else np.asarray(values, float)
        return self.with_term(Term(effect, start))

    def with_values(self, name: str, values: Values) -> "Model":
        term = self.term(name)
        assert term is not None
        return self.with_term(replace(term, values=values))

    def without(self, name: str) -> "Model":
        return replace(self, terms=tuple(t for t in self.terms if t.name != name))

    def without_finding(self, name: str) -> "Model":
        """Return the model without a term; with a map as strong as the profile says, if
        it says that."""
        term = self.term(name)
        is_map = term is not None and isinstance(term.effect, FixedPattern)
        if term is None or not is_map or name not in self.profile_parameters:
            return self.without(name)
        return self.with_term(replace(term, calibration=True, held=True))

    def noise_gain(self, betas: str) -> float:
        """Return what multiplies betas of the noise model."""
        logs = [float(t.values[0]) for t in self.terms if t.effect.scales == betas]
        return float(np.exp(sum(logs)))

    def values_of(self, effect: Effect, frame: Frame) -> Values | None:
        """Return the values by which an effect whitens a frame: a term's, or what the
        profile has; None if neither. What moves a prediction comes on top of what the
        profile has."""
        term = self.term(effect.name)
        if not effect.predicted:
            drawn = frame.noise.drawn.get(effect.name)
            given = None if drawn is None else np.array(drawn)
            return given if term is None else term.values
        given = self._listed_values(effect)
        if term is None:
            return given
        added = term.values if given is None else effect.added(given, term.values)
        return effect.within_registry_bounds(added)

    def within_bounds(self, name: str) -> "Model":
        """Return the model with values of an effect that, together with the profile's,
        are such as the registry simulates: beyond these nothing changes."""
        term = self.term(name)
        assert term is not None
        given = self._listed_values(term.effect)
        if given is None or not term.effect.predicted:
            return self
        added = term.effect.added(given, term.values)
        beyond = term.effect.within_registry_bounds(added) - added
        return self.with_values(name, term.values + beyond)

    def _listed_values(self, effect: Effect) -> Values | None:
        """Return the values of an effect in the profile; None if it has none."""
        listed = self.profile_parameters.get(effect.name)
        return None if listed is None else np.array(list(listed.values()), float)

    def of_few_tiles(self, frames: Sequence[Frame]) -> "Model":
        """Return the model with its maps where frames show a few of their tiles."""
        few = {f.signal.shape: f.tiles.few for f in frames if f.tiles.few is not None}
        model = self
        for term, _, known in self.maps:
            places = few.get(known.mean.shape)
            if places is not None:
                of_few = replace(term, sensor_map=known.of_tiles(places))
                model = model.with_term(of_few)
        return model

    def without_maps(self, names: Sequence[str] | None = None) -> "Model":
        """Return the model with its maps, or those of some names, unknown, as strong as
        they are."""
        terms = tuple(
            replace(term, sensor_map=None)
            if names is None or term.name in names
            else term
            for term in self.terms
        )
        return replace(self, terms=terms)

    @property
    def profile_parameters(self) -> Mapping[str, Mapping[str, float]]:
        """Parameters of the effects that the sensor's profile has, in the order of the
        registry."""
        return _parameters_of(self.sensor)

    @property
    def warm_parameters(self) -> Mapping[str, Mapping[str, float]]:
        """profile_parameters at the temperature of dark current that was found, but for
        dark current itself."""
        listed = self.profile_parameters
        dark = self.term(DARK_CURRENT) if self.by_temperature else None
        if dark is None or DARK_CURRENT not in listed:
            return listed
        ratio = ratio_to_stated(float(dark.values[0]), *listed[DARK_CURRENT].values())
        return {
            name: {
                parameter: (ratio if RATES.get(name) == parameter else 1.0) * value
                for parameter, value in stated.items()
            }
            for name, stated in listed.items()
        }


@lru_cache(maxsize=SENSORS_KNOWN)
def _parameters_of(sensor: Sensor) -> Mapping[str, Mapping[str, float]]:
    return {
        entry["name"]: stated_by(entry, sensor.cfa) for entry in sensor.effects or ()
    }


def _anywhere(sensor_map: SensorMap) -> SensorMap:
    """Return what a map says of a pixel of which nothing is known, as numbers."""
    mean, variance = (
        np.array(part.mean()) for part in (sensor_map.mean, sensor_map.variance)
    )
    chance = sensor_map.chance
    return SensorMap(
        mean, variance, chance=None if chance is None else np.array(chance.mean())
    )
