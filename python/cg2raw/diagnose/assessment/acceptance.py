# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Acceptance: which effects that the search found may be named.

These rules only take names away. An effect that may as well be absent, or whose value
lies where the search could not go on, is no finding; and a model that does not make
whole held-out frames more likely than the baseline does is none at all.
"""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.effects.catalogue import heading, title
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.intervals import SmoothValues, estimates
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

AT_ITS_END = ", where the search ends"
ON_BOUND = 1e-6  # of the distance between bounds
# Nats that whole held-out frames must gain. By chance, a model that is no better gains
# as much in one case of twenty at most. Source: as of the search, Ville's inequality.
CONFIRMING_GAIN = float(np.log(20))


def founded(
    model: Model, likelihood: Likelihood
) -> tuple[Model, EstimatesByEffect, dict[str, str]]:
    """Return (model of the effects that may be named, their estimates, why others may
    not by name).

    likelihood : of the frames that it was fitted to, and is fitted to again without
    them."""
    refused: dict[str, str] = {}
    clear: set[str] = set()
    while True:
        values = estimates(model, likelihood)
        reasons = {
            term.name: reason
            for term in model.terms
            if not term.calibration
            and term.name not in clear
            and (reason := _unfounded(model, term, values))
        }
        if not reasons:
            return model, values, refused
        smooth = SmoothValues.of(model, likelihood)
        name, rest = _least_founded(model, likelihood, reasons, smooth)
        if _is_clear_together(model, name, smooth):
            clear.add(name)
            continue
        refused[name] = reasons[name]
        model = rest


def _least_founded(
    model: Model,
    likelihood: Likelihood,
    reasons: Mapping[str, str],
    smooth: SmoothValues,
) -> tuple[str, Model]:
    """Return (one of the names that are not founded, the model fitted without it): that
    by which least is lost, were noise all that moves values.

    One at a time: without it the others may lie elsewhere. A value that went to a bound
    took others along; then what matters least comes first."""
    on_bound = [name for name, reason in reasons.items() if reason.endswith(AT_ITS_END)]
    height = likelihood.total(model)
    found = []
    for name in on_bound[:1] or reasons:
        rest = fit(model.without(name), likelihood)
        lost = height - likelihood.total(rest)
        found.append((name, rest, lost / smooth.widening(name)))
    name, rest, _ = min(found, key=lambda one: one[2])
    return name, rest


def _is_clear_together(model: Model, name: str, smooth: SmoothValues) -> bool:
    """Return whether smooth values are not all null, though each may be: two of which
    frames tell the difference.
    """
    term = model.term(name)
    assert term is not None
    used = term.effect.switches or term.effect.used
    count = len(used)
    if count < 2 or term.effect.estimator != "smooth" or _bound_of(model, term, ()):
        return False
    return smooth.square_of_distance(name, used) > float(chi2.ppf(0.95, count))


def _unfounded(model: Model, term: Term, values: EstimatesByEffect) -> str:
    """Return why an effect may not be named; nothing if it may."""
    parameters = values[term.name]
    switches = term.effect.switches or tuple(parameters)
    if all(_holds_null(parameters[name]) for name in switches):
        held = " and ".join(f"{name} 0" for name in switches)
        return f"its 95 % interval holds {held}"
    empty = {
        shape
        for shape, of in term.effect.shape_of.items()
        if _holds_null(parameters[of])
    }
    bound = _bound_of(model, term, empty)
    return bound + AT_ITS_END if bound else ""


def _holds_null(estimate: Estimate) -> bool:
    low, high = estimate.ci95
    return not (low > 0 or high < 0)


def _bound_of(model: Model, term: Term, empty: Collection[str]) -> str:
    """Return which parameter sits on a bound that is not its null, in words.

    empty : parameters that say nothing."""
    effect = term.effect
    for name, value, bounds in zip(
        effect.parameters,
        term.values,
        zip(effect.low, effect.high, strict=True),
        strict=True,
    ):
        bound = _reached(value, bounds)
        if bound and name not in empty:
            return f"{name} is {bound:g}"
    return _registry_bound(model, term, empty)


def _reached(value: float, bounds: tuple[float, float]) -> float:
    """Return the bound that a value sits on or beyond; 0 if it sits on none, or on
    that."""
    low, high = bounds
    near = ON_BOUND * (high - low)
    return low if value < low + near else high if value > high - near else 0.0


def _registry_bound(model: Model, term: Term, empty: Collection[str]) -> str:
    """The same of what is found and what the profile has together."""
    effect = term.effect
    if effect.search or not effect.predicted:
        return ""
    listed = model.profile_parameters.get(term.name, {})
    sums = term.values
    if listed:
        sums = effect.added(np.array(list(listed.values()), float), sums)
    beside = " together with the profile's" if listed else ""
    bounds = zip(*effect.registry_bounds, strict=True)
    for name, total, ends in zip(effect.parameters, sums, bounds, strict=True):
        bound = _reached(total, ends)
        if bound and name not in {*empty, *effect.ends}:
            return f"{name} is {bound:g}{beside}"
    return ""


def is_better(before: Sums, after: Sums) -> bool:
    """Return whether whole held-out frames are more likely by more than chance."""
    return after.log_likelihood - before.log_likelihood >= CONFIRMING_GAIN


def refusals(refused: Mapping[str, str]) -> list[str]:
    """Return a sentence on each effect that may not be named."""
    return [
        f"{heading(name)} is not named, though it was found: {reason}."
        for name, reason in refused.items()
    ]


def not_better(names: Sequence[str], before: Sums, after: Sums) -> str:
    """Return a sentence on effects that the report frames do not confirm."""
    gain = after.log_likelihood - before.log_likelihood
    listed = ", ".join(title(name) for name in names)
    more = "more" if gain > 0 else "less"
    return (
        f"Not confirmed: with {listed} the report frames, whole, are {more} likely by "
        f"{abs(gain):.1f} nats; a name needs {CONFIRMING_GAIN:.1f} more. The profile "
        "stays as it is."
    )
