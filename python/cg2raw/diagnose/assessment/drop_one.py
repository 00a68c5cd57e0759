# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Drop-one: what the select frames lose if all effects but one explain them.

Both models are fitted as long.
"""

from functools import cache, cached_property

import numpy as np

from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood, log_density
from cg2raw.diagnose.likelihood.model import Model

QUICK_TURNS = 1  # of a fit without one effect, which starts at that with it
NOTHING = 0.01  # nats of a pixel; less does not count as an effect


class DropOne:
    """The losses of a model's effects. Each is fitted once."""

    def __init__(self, model: Model, splits: Splits) -> None:
        self._start, self._splits = model, splits
        self._rest = cache(self._fitted_without)

    def loss(self, name: str) -> float:
        """Return what all select frames lose without an effect, nats."""
        return self._loss(name, self._splits.select)

    def loss_elsewhere(self, name: str, larger: str) -> float:
        """Return what those of them lose on which a larger effect does not act."""
        select = self._splits.select
        frames = [f for f in select.frames if not acts_on(self._whole, larger, f)]
        return self._loss(name, select.of(frames))

    @cached_property
    def _whole(self) -> Model:
        return fit(self._start, self._splits.fit, QUICK_TURNS)

    def _fitted_without(self, name: str) -> Model:
        rest = fit(self._start.without(name), self._splits.fit, QUICK_TURNS)
        if effect(name).moves_mean:
            # Noise as wide as what is missing, or a level of each frame, is no answer.
            for term in self._whole.terms:
                if not term.effect.moves_mean and term.name != name:
                    rest = rest.with_term(term)
        return rest

    def _loss(self, name: str, frames: Likelihood) -> float:
        return frames.total(self._whole) - frames.total(self._rest(name))


def acts_on(model: Model, name: str, frame: Frame) -> bool:
    """Return whether an effect changes what a frame's pixels are expected to be."""
    density, rest = (log_density(m, frame)[0] for m in (model, model.without(name)))
    changed = np.mean((density - rest)[frame.counted] ** 2)
    return bool(changed > NOTHING**2)
