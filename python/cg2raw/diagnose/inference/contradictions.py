# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Contradictions: maps that are not as strong as a profile says.

A profile says how strong the fixed patterns of its sensor are, and captures show where.
That holds until the fit frames lose NEARLY nats per pixel by it. If maps that the
select frames make by themselves lose as much, it is a finding.
"""

from collections.abc import Collection
from dataclasses import replace

from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model


def contradicted(model: Model, select: Likelihood) -> dict[str, float]:
    """Return the nats that maps of the select frames lose by what the profile says of
    them, of those that the fit frames contradict as well, largest first.

    model : with maps of the fit frames."""
    doubted = [t.name for t in model.terms if t.calibration and t.contradicted > 0]
    lost = lost_as_stated(model, doubted, select)
    return dict(sorted(lost.items(), key=lambda one: -one[1]))


def lost_as_stated(
    model: Model, names: Collection[str], frames: Likelihood
) -> dict[str, float]:
    """Return the nats that maps lose by what the profile says of them, if frames make
    them anew, of those names where that does not hold."""
    if not names:
        return {}
    terms = [
        replace(t, calibration=t.calibration or t.name in names) for t in model.terms
    ]
    again = fit_patterns(replace(model, terms=tuple(terms)), frames)
    lost = {t.name: t.contradicted for t in again.terms if t.name in names}
    return {name: nats for name, nats in lost.items() if nats > 0}


def as_finding(model: Model, name: str) -> Model:
    """Return a model one of whose maps is a finding, and not as strong as the profile
    says."""
    term = model.term(name)
    assert term is not None
    return model.with_term(replace(term, calibration=False))
