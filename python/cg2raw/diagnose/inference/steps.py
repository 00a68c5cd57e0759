# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Steps of a search: what was tried, what was taken, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.model import Model

MEAN_FIRST = 0.25  # of the gain that an effect of the mean needs to go first


@dataclass(frozen=True)
class Trial:
    """A candidate that was fitted: what it gains on the select frames, nats.

    evidence : the gain, less what the model without it gains by moving there."""

    name: str
    gain: float
    blocks: Array
    model: Model
    evidence: float = -np.inf


@dataclass(frozen=True)
class Step:
    """One change of the model. ambiguous: names that explain it as well. rule: why this
    one of the ranking, in words."""

    action: str
    name: str
    gain: float
    evidence: float = 0.0
    ranking: Sequence[tuple[str, float]] = ()
    ambiguous: Sequence[str] = ()
    rule: str = ""


def rule_of(best: Trial, first: Trial, trials: Sequence[Trial]) -> str:
    """Return why one of the trials was taken, in words."""
    if best is not first:
        return (
            f"It and {first.name} explain these frames alike: the one with fewer "
            "parameters is taken."
        )
    top = max(trials, key=lambda trial: trial.gain)
    if best is top:
        return "It gains most on the held-out frames."
    if top.evidence < best.evidence:
        return f"{top.name} gains more, but is not sure."
    return (
        f"{top.name} gains more, but takes up any error of the mean: "
        f"an effect of the mean that gains {MEAN_FIRST:.0%} as much goes first."
    )


def mean_first(trials: Sequence[Trial], effects: Sequence[Effect]) -> Trial:
    """Return which of the trials, best first, goes first: noise absorbs any misfit of
    the mean, and an effect of the mean goes before it."""
    kinds = {effect.name: effect for effect in effects}
    best = trials[0]
    if not kinds[best.name].absorbs:
        return best
    for trial in trials:
        known = kinds[trial.name]
        enough = trial.gain > MEAN_FIRST * best.gain
        if known.moves_mean and not known.absorbs and enough:
            return trial
    return best
