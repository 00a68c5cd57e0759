# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Acceptance: which effects that the search found may be named.

These rules only take names away. An effect that may as well be absent, or whose value
lies where the search could not go on, is no finding; and a model that does not make
whole held-out frames more likely than the baseline does is none at all.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.effects.catalogue import heading, title
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.intervals import estimates
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

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
        # One at a time: without it the others may lie elsewhere.
        name = next(iter(reasons))
        rest = fit(model.without(name), likelihood)
        gained = likelihood.total(model) - likelihood.total(rest)
        if _is_clear_together(model, name, gained):
            clear.add(name)
            continue
        refused[name] = reasons[name]
        model = rest


def _is_clear_together(model: Model, name: str, gained: float) -> bool:
    """Return whether smooth values are not all null, though each may be: two of which
    frames tell the difference. gained : by them, nats. Source: S. S. Wilks, Ann. Math.
    Stat. 9(1), 1938."""
    term = next(term for term in model.terms if term.name == name)
    count = len(term.values)
    if count < 2 or term.effect.estimator != "smooth" or _bound_of(model, term):
        return False
    return gained > float(chi2.ppf(0.95, count)) / 2


def _unfounded(model: Model, term: Term, values: EstimatesByEffect) -> str:
    """Return why an effect may not be named; nothing if it may."""
    parameters = values[term.name]
    switches = term.effect.switches or tuple(parameters)
    if all(_holds_null(parameters[name]) for name in switches):
        held = " and ".join(f"{name} 0" for name in switches)
        return f"its 95 % interval holds {held}"
    bound = _bound_of(model, term)
    return f"{bound}, where the search ends" if bound else ""


def _holds_null(estimate: Estimate) -> bool:
    low, high = estimate.ci95
    return not (low > 0 or high < 0)


def _bound_of(model: Model, term: Term) -> str:
    """Return which parameter sits on a bound that is not its null, in words."""
    effect = term.effect
    if effect.estimator == "fixed pattern":
        return ""
    rows = zip(effect.parameters, term.values, effect.low, effect.high, strict=True)
    for name, value, low, high in rows:
        near = ON_BOUND * (high - low)
        for bound in (low, high):
            if bound != 0 and abs(value - bound) < near:
                return f"{name} is {bound:g}"
    return _registry_bound(model, term)


def _registry_bound(model: Model, term: Term) -> str:
    """The same of what is found and what the profile has together."""
    listed = model.profile_parameters.get(term.name, {})
    if len(listed) != len(term.values):
        return ""
    sums = np.array(list(listed.values()), float) + term.values
    bounded = term.effect.within_registry_bounds(sums)
    for name, total, kept in zip(term.effect.parameters, sums, bounded, strict=True):
        if total != kept:
            return f"{name} is {kept:g} together with the profile's"
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
