# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Full start: all effects that darks and flats measure, at once.

A real sensor has ten effects. Added one by one to a bare profile, the first that is
noise takes up all others. So moments say how large noise and pedestal are, maps are
made under that noise, then everything is fitted together, to a few tiles of large
frames and then to all; what is not needed is dropped afterwards. Source of the order:
EMVA Standard 1288, release 4.0.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from cg2raw.diagnose.effects.base import Effect, Moments
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.coordinate_search import fit_transform
from cg2raw.diagnose.inference.fitting import (
    begun_from_data,
    drawn_by_profile,
    fit,
    scored,
)
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.illumination import (
    SHADING,
    as_lit_with_gain,
    without_unsure_shading,
)
from cg2raw.diagnose.inference.moments import moments_of
from cg2raw.diagnose.inference.outliers import without_outliers
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.warmth import as_warm, reading_error, warmed
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

ROUNDS = 3  # of maps and what is smooth, by turns, before noise is fitted
ROUNDS_MORE = 2  # of the same, of all tiles after a few
# Of a frame's pixels, that are set aside of those far from a model that is half fitted.
MOST_OUT = 0.03
MOST_OUTLIERS = 2e-3  # of a frame's pixels, that are set aside from the fitted one


@dataclass(frozen=True)
class Start:
    """A model that a search starts from, and the frames without what it sets aside.

    light : the model beside which flats showed their light. light_gain : nats that the
    select frames gain by that light."""

    model: Model
    splits: Splits
    light: Model
    light_gain: float


def full_start(baseline: Baseline, effects: Sequence[Effect]) -> Start | None:
    """Return the fit of all effects that uniform frames measure; None if too few of
    them repeat each other.

    effects : that may be named."""
    splits = baseline.splits
    moments = moments_of(baseline.model, splits.fit.of(uniform_of(splits.fit)))
    chosen = [effect for effect in effects if effect.measured_by_uniform_frames]
    if moments.read is None or not chosen:
        return None
    model, later = _begun(baseline.model, chosen, moments, splits.few or splits)
    noise = [e.name for e in chosen if e.scales]
    error = reading_error(splits.frames, "temperature" in baseline.free)
    start = _fitted(model, later, splits.few or splits, noise, error)
    return start if splits.few is None else _on_all_tiles(start, splits, noise, error)


def _begun(
    model: Model, chosen: Sequence[Effect], moments: Moments, splits: Splits
) -> tuple[Model, list[Term]]:
    """Return (model where moments and data say, terms that come later)."""
    model = _with_all(model, chosen, moments, splits.fit.frames)
    later = [term for term in model.terms if term.effect.estimator == "transform"]
    later = [term for term in later if term.effect in chosen]
    for term in later:
        model = model.without(term.name)
    near = trimmed(model, splits)
    for effect in chosen:
        if effect.starts_from_data and model.term(effect.name) is None:
            # What a profile has is there already, and moves from where it is.
            if effect.name in model.profile_parameters:
                model = model.with_effect(effect)
            else:
                uniform = near.fit.of(uniform_of(near.fit))
                model = begun_from_data(effect, model, uniform) or model
    return model, later


def _begun_again(model: Model, likelihood: Likelihood, noise: Sequence[str]) -> Model:
    """Return the model with what starts from data started anew beside all others, where
    that is better: what it was found in was not understood then, and columns have
    taken what it left.

    noise : names of what rests."""
    height, uniform = likelihood.total(model), likelihood.of(uniform_of(likelihood))
    columns = [t.name for t, effect, _ in model.maps if effect.layout == "columns"]
    for term in model.terms:
        listed = term.name in model.profile_parameters
        if listed or not term.effect.starts_from_data:
            continue
        rest = model.without(term.name).without_maps(columns)
        again = begun_from_data(term.effect, rest, uniform)
        if again is None:
            continue
        again = fit_patterns(again, likelihood, columns) if columns else again
        again, higher = scored(again, likelihood.total(again), likelihood, noise)
        if higher > height:
            model, height = again, higher
    return model


def _by_turns(
    model: Model,
    shown: Splits,
    splits: Splits,
    rounds: int,
    noise: Sequence[str],
    error: float,
) -> tuple[Model, Splits]:
    """Return (model after rounds of maps and of what is smooth, frames as warm as it
    says they are). What starts from data is begun again before the last of them.

    shown : what the first maps are made of. noise, error : see _fitted()."""
    for number in range(rounds):
        model = fit_patterns(model, shown.fit)
        splits = warmed(model, splits, error)
        shown = trimmed(model, splits)
        model, _ = scored(model, shown.fit.total(model), shown.fit, noise)
        if number == rounds - 2:
            model = _begun_again(model, shown.fit, noise)
    return model, splits


def _fitted(
    model: Model,
    later: Sequence[Term],
    splits: Splits,
    noise: Sequence[str],
    error: float,
) -> Start:
    """Return the fit of a model that has no maps yet.

    later : terms that are fitted after maps are known. noise : names of what rests
    until then. error : of readings of the temperature."""
    model, splits = _by_turns(model, splits, splits, ROUNDS, noise, error)
    light = model = without_unsure_shading(model, splits.fit.frames)
    splits, gain = as_lit_with_gain(light, splits)
    model = fit_patterns(model, trimmed(model, splits).fit)
    shown = trimmed(model, splits)
    for term in later:
        model, _ = fit_transform(model.with_term(term), term.name, shown.fit)
    model = fit(model, shown.fit)
    shown = without_outliers(model, splits, MOST_OUTLIERS)
    return Start(fit(model, shown.fit), shown, light, gain)


def _on_all_tiles(
    start: Start, splits: Splits, noise: Sequence[str], error: float
) -> Start:
    """Return what was fitted to a few tiles fitted to all. noise, error : as above."""
    warm = as_warm(splits, start.splits)
    light = start.light.without_maps()
    light, splits = _by_turns(light, splits, warm, ROUNDS_MORE, noise, error)
    # What flats show beside a model is their light: it has to be the best of all tiles.
    light = without_unsure_shading(light, splits.fit.frames)
    splits, gain = as_lit_with_gain(light, splits)
    model = start.model if light.term(SHADING) else start.model.without(SHADING)
    for term in light.terms:
        if term.name not in noise:
            model = model.with_term(term)
    model = fit_patterns(model, trimmed(model, splits).fit)
    model = fit(model, trimmed(model, splits).fit, 1)
    shown = without_outliers(model, splits, MOST_OUTLIERS)
    return Start(fit(model, shown.fit, 1), shown, light, gain)


def trimmed(model: Model, splits: Splits) -> Splits:
    """Return the frames without what is farthest from a model that is half fitted."""
    return without_outliers(model, splits, MOST_OUT, trimmed=True)


def uniform_of(likelihood: Likelihood) -> list[Frame]:
    return [f for f in likelihood.frames if not f.capture.shows.image]


def _with_all(
    model: Model, effects: Sequence[Effect], moments: Moments, frames: Sequence[Frame]
) -> Model:
    """Return the model with effects where moments say; what calibrates it stays so."""
    for effect in effects:
        drawn = drawn_by_profile(effect, frames)  # a profile is near to that
        values = effect.clipped(
            effect.from_moments(moments) if drawn is None else drawn
        )
        if model.term(effect.name) is None and not effect.starts_from_data:
            model = model.with_effect(effect, values)
        elif effect.scales and not effect.starts_from_data:
            model = model.with_values(effect.name, values)
    return model
