# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Admission: which candidates may be added to a model.

Beside the nats that a name needs, what gains them must not be what a model lacks of
another effect: light that nobody measured, structure of a mean, or a larger effect.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.repeats import evidence_of_noise
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model

# Of what flats gain by the light that they show: a lamp drifts, and is not quite slow.
LIGHT_LEAVES = 0.02
NOTHING = 0.01  # nats of a pixel; less does not count as an effect


@dataclass(frozen=True)
class Admission:
    """The rules of one step of a search.

    light_gain : nats that flats gain by light that nobody measured. losses : nats that
    the select frames lose without each effect that was there before any was added."""

    candidates: Candidates
    light_gain: float
    losses: Mapping[str, float]

    def admits(self, trial: Trial) -> bool:
        """Return whether an effect is sure, and none of what others leave."""
        left = LIGHT_LEAVES * self.light_gain * effect(trial.name).acts_on_light
        sure = trial.evidence >= max(self.candidates.threshold, left)
        return sure and self._is_noise(trial) and self._is_its_own(trial)

    def _is_noise(self, trial: Trial) -> bool:
        """Return whether noise that correlates is seen between repeats, too: structure
        that the mean lacks makes neighbours alike as well."""
        if not effect(trial.name).correlates:
            return True
        rest = trial.model.without(trial.name)
        found = evidence_of_noise(trial.model, rest, self.candidates.splits)
        return found is None or found >= self.candidates.threshold

    def _is_its_own(self, trial: Trial) -> bool:
        """Return whether an effect is more than what the models of larger ones do not
        describe: it gains a share of them or, of a mean, where they do not act. (Pixels
        that are hot in long darks are noisier than others in short ones, too.)"""
        one = effect(trial.name)
        return one.shows_without_image or all(
            trial.gain >= effect(larger).taken_up_by.get(trial.name, 0.0) * loss
            or (one.moves_mean and self._is_sure_elsewhere(trial, larger))
            for larger, loss in self.losses.items()
        )

    def _is_sure_elsewhere(self, trial: Trial, larger: str) -> bool:
        select, null = self.candidates.splits.select, self.candidates.null
        frames = select.of([f for f in select.frames if not acts_on(null, larger, f)])
        return (
            frames.total(trial.model) - frames.total(null) > self.candidates.threshold
        )


def acts_on(model: Model, name: str, frame: Frame) -> bool:
    """Return whether an effect changes what a frame's pixels are expected to be."""
    density, rest = (log_density(m, frame)[0] for m in (model, model.without(name)))
    changed = np.mean((density - rest)[frame.counted] ** 2)
    return bool(changed > NOTHING**2)
