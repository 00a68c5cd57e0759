# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Contradictions: maps that are not as strong as a profile says.

A profile says how strong the fixed patterns of its sensor are, and captures show where.
That holds until the fit frames lose NEARLY nats per pixel by it. If maps that the
select frames make by themselves lose as much, it is a finding; of a normal map, if what
both have in common says so, too. Noise that the model lacks is in both as well, and is
not the same.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import blending

FARTHEST_COUNTED = 4.0  # standard deviations that a pixel counts for at most


def contradicted(model: Model, splits: Splits) -> dict[str, float]:
    """Return the nats that maps of the select frames lose by what the profile says of
    them, of those that the fit frames contradict as well, largest first.

    model : with maps of the fit frames. How strong maps were before a camera blended
    them is known less well than that: then nothing is asked."""
    if list(blending(model, splits.fit.frames[0])):
        return {}
    doubted = [t.name for t in model.terms if t.calibration and t.contradicted > 0]
    if not splits.hold_out_frames:  # columns are the same in all splits
        columns = {e.name for _, e, _ in model.maps if e.layout == "columns"}
        doubted = [name for name in doubted if name not in columns]
    lost = lost_as_stated(model, doubted, splits.select)
    return dict(sorted(lost.items(), key=lambda one: -one[1]))


def lost_as_stated(
    model: Model, names: Collection[str], frames: Likelihood
) -> dict[str, float]:
    """Return the nats that maps lose by what the profile says of them, if frames make
    them anew, of those names where that does not hold.

    model : with maps of other frames; what is not the same in both is noise that the
    model lacks, and no map."""
    if not names:
        return {}
    terms = [
        replace(t, calibration=t.calibration or t.name in names) for t in model.terms
    ]
    again = fit_patterns(replace(model, terms=tuple(terms)), frames)
    lost = {}
    for old, new in zip(terms, again.terms, strict=True):
        if new.name in names and new.contradicted > 0:
            lost[new.name] = min(new.contradicted, _lost_by_repeats(model, old, new))
    return {name: nats for name, nats in lost.items() if nats > 0}


def _lost_by_repeats(model: Model, old: Term, new: Term) -> float:
    """Return the nats by which the covariance of two estimates of a normal map, which
    no noise has, is not the variance that the profile says; infinite of others."""
    told = [one.sensor_map.told for one in (old, new) if one.sensor_map is not None]
    if len(told) < 2 or told[0] is None or told[1] is None:
        return np.inf
    (a, a_error), (b, b_error) = told[0], told[1]
    stated = model.profile_parameters[old.name]["sigma"] ** 2
    known = np.isfinite(a_error) & np.isfinite(b_error)
    spreads = [np.sqrt(error[known] + stated) for error in (a_error, b_error)]
    a, b = (
        np.clip(one[known] / spread, -FARTHEST_COUNTED, FARTHEST_COUNTED)
        for one, spread in zip((a, b), spreads, strict=True)
    )
    # Of values in units of their spread, what they have in common is this much of each.
    weight = 1 / (spreads[0] * spreads[1])
    common = stated * weight
    excess = float((weight * (a * b - common)).sum())
    variance = float((weight**2 * (1 + common**2)).sum())
    return 0.5 * excess**2 / variance


def as_finding(model: Model, name: str) -> Model:
    """Return a model one of whose maps is a finding, and not as strong as the profile
    says."""
    term = model.term(name)
    assert term is not None
    return model.with_term(replace(term, calibration=False))
