# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Findings: the accepted effects in words, without those that complete another."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.assessment.drop_one import DropOne
from cg2raw.diagnose.diagnosis import (
    LARGEST_E,
    Alternative,
    Finding,
    Rung,
)
from cg2raw.diagnose.effects.base import EstimatesByEffect
from cg2raw.diagnose.effects.catalogue import effect, heading, title
from cg2raw.diagnose.effects.discriminating_captures import sentence
from cg2raw.diagnose.inference.model_selection import Search
from cg2raw.diagnose.inference.steps import Step
from cg2raw.diagnose.likelihood.model import Model


def findings_of(
    model: Model,
    steps: Sequence[Step],
    values: EstimatesByEffect,
    provisional: bool,
) -> list[Finding]:
    """Return the terms of a model that are findings, as they were accepted.

    A name without a step is none: time was up before it was tested."""
    findings = []
    last = {step.name: step for step in steps}
    for name in filter(last.__contains__, model.found_names):
        step = last[name]
        others = [Alternative(n, height) for n, height in step.ranking if n != name]
        findings.append(
            Finding(
                name=name,
                parameters=values[name],
                gain_nats=step.gain,
                e_value=_e_value(step.evidence),
                alternatives=others,
                ambiguous_with=list(step.ambiguous),
                where=effect(name).where,
                sentence=sentence(name, values[name], model.sensor),
                provisional=provisional,
                rule=step.rule,
            )
        )
    return findings


def _e_value(evidence: float) -> float:
    """Return the e-value of nats, as far as it is written."""
    return LARGEST_E if evidence >= np.log(LARGEST_E) else float(np.exp(evidence))


def without_shapes(
    findings: Sequence[Finding], model: Model, search: Search
) -> tuple[list[Finding], list[str]]:
    """Return (findings, notes on those that are no findings).

    An effect's model has a shape; what the true one has beside it is taken up by
    another. That stays in the model, and is not called an effect of its own. What is
    shown by frames on which the larger effect does not act is none of its shape."""
    gains = {finding.name: finding.gain_nats for finding in findings}
    drop_one = DropOne(model, search.splits)
    kept, notes = [], []
    for finding in findings:
        least = {
            larger: effect(larger).taken_up_by[finding.name] * gains[larger]
            for larger in gains
            if finding.name in effect(larger).taken_up_by
        }
        larger = _taken_up(finding.name, least, drop_one, search.threshold)
        if not larger:
            kept.append(finding)
            continue
        share = drop_one.loss(finding.name) / gains[larger]
        notes.append(
            f"{heading(finding.name)} takes up what the model of "
            f"{title(larger)} does not describe ({share:.1%} of its gain): it is in "
            "the profile, and is no finding of its own."
        )
    return kept, notes


def _taken_up(
    name: str, least: Mapping[str, float], drop_one: DropOne, threshold: float
) -> str:
    """Return the larger effect of whose shape one is; nothing if it is one of its own.

    least : nats by larger effects that it has to gain beside them."""
    for larger, nats in least.items():
        # What it gained when it was added may since be explained by others.
        if drop_one.loss(name) < nats:
            if drop_one.loss_elsewhere(name, larger) <= threshold:
                return larger
    return ""


def with_losses(
    findings: Sequence[Finding], model: Model, search: Search
) -> list[Finding]:
    """Return findings with what is lost without each of them, all others fitted once
    more: drop-one. Two that stand in for each other lose little each."""
    drop_one = DropOne(model, search.splits)
    return [replace(one, loss_nats=drop_one.loss(one.name)) for one in findings]


def rung_of(step: Step) -> Rung:
    """Return one step of the search as the report shows it."""
    ranking = [Alternative(name, gain) for name, gain in step.ranking]
    return Rung(step.action, step.name, step.gain, ranking, step.rule)


def refused_rung(name: str) -> Rung:
    """Return the step of an effect that was found and may not be named."""
    return Rung("dropped", name, 0.0, [], "It may not be named: see the notes.")
