# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Ties: effects that explain the same frames alike, of which the simplest is named."""

from collections.abc import Sequence

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.inference.steps import Trial

CLEAR = 5.0  # nats between two names: an e-value ratio of 150
CLEAR_SHARE = 0.05  # of the gain


def simplest_of_ties(
    best: Trial,
    trials: Sequence[Trial],
    effects: Sequence[Effect],
    threshold: float,
) -> tuple[Trial, list[str]]:
    """Return (the trial to accept, names that are as good); a tie goes to the one with
    fewer parameters, but not to noise.

    threshold : nats that a name must gain."""
    known = {effect.name: effect for effect in effects}
    tied = [t for t in trials if t is not best and _is_tied(t, best)]
    able = [
        best,
        *(
            trial
            for trial in tied
            if trial.evidence >= threshold
            and (known[best.name].absorbs or not known[trial.name].absorbs)
        ),
    ]
    simplest = min(able, key=lambda trial: (len(known[trial.name].used), -trial.gain))
    if best.gain - simplest.gain >= CLEAR:
        simplest = best
    others = [t.name for t in [best, *tied] if t.name != simplest.name]
    return simplest, others


def _is_tied(trial: Trial, best: Trial) -> bool:
    if trial.gain > best.gain:
        return False
    lead = best.blocks - trial.blocks
    unsure = lead.sum() < 2 * lead.std() * np.sqrt(lead.size)
    small = lead.sum() < CLEAR_SHARE * best.gain
    return bool(lead.sum() < CLEAR or (unsure and small))
