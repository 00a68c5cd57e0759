# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Ties: effects that explain the same frames alike, of which the simplest is named."""

from collections.abc import Mapping, Sequence

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.inference.steps import Trial

CLEAR = 5.0  # nats between two names: an e-value ratio of 150
CLEAR_SHARE = 0.05  # of the gain
MAP_COST = 1000  # parameters that a map counts as


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
    shared = _shares_maps(best, known)
    tied = [t for t in trials if t is not best and _is_tied(t, best, shared)]
    able = [
        best,
        *(
            trial
            for trial in tied
            if trial.evidence >= threshold
            and (known[best.name].absorbs or not known[trial.name].absorbs)
        ),
    ]
    simplest = min(able, key=lambda trial: (_cost(known[trial.name]), -trial.gain))
    if best.gain - simplest.gain >= CLEAR and not shared:
        simplest = best
    others = [t.name for t in [best, *tied] if t.name != simplest.name]
    return simplest, others


def _is_tied(trial: Trial, best: Trial, shared: bool) -> bool:
    """shared : a lead that the blocks of a frame do not agree on is none, however large
    it is."""
    if trial.gain > best.gain:
        return False
    lead = best.blocks - trial.blocks
    unsure = lead.sum() < 2 * lead.std() * np.sqrt(lead.size)
    small = shared or lead.sum() < CLEAR_SHARE * best.gain
    return bool(lead.sum() < CLEAR or (unsure and small))


def _shares_maps(trial: Trial, known: Mapping[str, Effect]) -> bool:
    """Return whether an effect that is no map itself stands beside maps. These are of
    the same pixels in all frames: what its parameters describe of the fit frames by
    chance is in held-out ones, too. What it describes beyond a simpler one it has to
    gain beside that."""
    is_map = known[trial.name].estimator == "fixed pattern"
    return not is_map and any(trial.model.maps)


def _cost(effect: Effect) -> int:
    return MAP_COST if effect.estimator == "fixed pattern" else len(effect.used)
