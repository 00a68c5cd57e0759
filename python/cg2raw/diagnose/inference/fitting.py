# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""fit(): all terms of a model together, each by its own estimator."""

from collections.abc import Collection, Sequence

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.coordinate_search import ENOUGH, fit_transform
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, one_step
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

TURNS = 2  # of smooth and other parameters
SCORING_STEPS = 7  # of Fisher scoring
SETTLED = 0.5  # nats between two turns


def fit(model: Model, likelihood: Likelihood, turns: int = TURNS) -> Model:
    """Return the model of maximum likelihood near a model.

    turns : of smooth and other parameters."""
    current = likelihood.total(model)
    for _ in range(turns):
        start = current
        model, current = scored(model, current, likelihood)
        if all(term.effect.estimator == "smooth" for term in model.terms):
            break
        for term in model.terms:
            # Scores of a variance are squares, which outliers decide.
            if term.effect.estimator == "transform" or term.effect.scales:
                model, _ = fit_transform(model, term.name, likelihood)
        current = likelihood.total(model)
        if abs(current - start) < SETTLED:
            break
    return model


def scored(
    model: Model, current: float, likelihood: Likelihood, held: Collection[str] = ()
) -> tuple[Model, float]:
    """Return (model after damped steps of Fisher scoring until they gain no more, its
    log-likelihood). Every other step takes the derivatives of the one before it.

    held : names of terms that rest."""
    base: Linearisation | None = None
    for number in range(SCORING_STEPS):
        base = Linearisation(model, likelihood, base if number % 2 else None)
        model, gain = one_step(model, base, current, held)
        current += gain
        if gain < ENOUGH:
            break
    return model, current


def drawn_by_profile(effect: Effect, frames: Sequence[Frame]) -> Values | None:
    """Return the values by which a profile draws an effect; None if it does not."""
    drawn = [frame.noise.drawn.get(effect.name) for frame in frames]
    return np.array(drawn[0], float) if drawn and drawn[0] is not None else None


def first_guess(effect: Effect, base: Linearisation) -> tuple[Model, float] | None:
    """Return (model with a first guess of an effect, its gain when fitted); None if
    frames show nothing of it.

    base : of the model that lacks it."""
    model, likelihood = base.model, base.likelihood
    in_profile = effect.name in model.profile_parameters  # and has a slope there
    if effect.starts_from_data and not in_profile:
        values = effect.first_values(likelihood.predicted(model))
        if values is None:
            return None
        start = model.with_effect(effect, effect.clipped(values))
        return start, likelihood.total(start) - base.height
    if effect.estimator == "smooth":
        start, gain = one_step(model.with_effect(effect), base, base.height)
        if gain > 0 or not effect.scales:
            return start, gain
        start, height = fit_transform(start, effect.name, likelihood, quick=True)
        return start, height - base.height
    if effect.estimator == "transform":
        drawn = drawn_by_profile(effect, likelihood.frames)
        first = np.array(effect.starts[0]) if drawn is None else drawn
        start = model.with_effect(effect, effect.clipped(first))
        # Where a profile has it, nothing is gained before it is fitted.
        is_new = drawn is None
        start, score = fit_transform(start, effect.name, likelihood, quick=is_new)
        return start, score - base.height
    raise ValueError(f"{effect.name}: is none that images are searched for")
