# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Detail: parameters of an effect that few captures need, where frames ask for them."""

from dataclasses import replace

from cg2raw.diagnose.inference.candidates import LEAST_SCORE
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, one_step
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model


def in_detail(model: Model, splits: Splits, threshold: float) -> Model:
    """Return the model with its effects in as much detail as gains the select frames
    more than a threshold, nats: what most do without is no reason for another name."""
    for term in model.terms:
        finer = term.effect.in_detail
        if finer is None or term.calibration:
            continue
        other = model.with_term(replace(term, effect=finer))
        base = Linearisation(other, splits.fit)
        begun, gain = one_step(other, base, base.height)
        if gain < LEAST_SCORE + len(finer.detail):
            continue
        other = fit(begun, splits.fit)
        if splits.select.total(other) - splits.select.total(model) > threshold:
            model = other
    return model
