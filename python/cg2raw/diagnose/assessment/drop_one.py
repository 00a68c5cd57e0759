# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Drop-one: what the select frames lose if all effects but one explain them.

Both models are fitted as long.
"""

from functools import cache, cached_property

from cg2raw.diagnose.effects.catalogue import effect
from cg2raw.diagnose.inference.admission import acts_on
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.pruning import TURNS_WITHOUT
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model


class DropOne:
    """The losses of a model's effects. Each is fitted once.

    quick : by a few tiles of large frames, which is enough but for what a frame has as
    a whole."""

    def __init__(self, model: Model, splits: Splits, quick: bool = True) -> None:
        few = splits.few if quick else None
        self._chosen = few or splits
        self._share = self._chosen.select.pixels / splits.select.pixels
        self._start = model.of_few_tiles(splits.frames) if few else model
        self._rest = cache(self._fitted_without)

    def loss(self, name: str) -> float:
        """Return what all select frames lose without an effect, nats."""
        return self._loss(name, self._chosen.select)

    def loss_elsewhere(self, name: str, larger: str) -> float:
        """Return what those of them lose on which a larger effect does not act. Noise
        that shows where there is no image is noise all the same."""
        anyway = effect(name).shows_without_image
        frames = [
            frame
            for frame in self._chosen.select.frames
            if (anyway and not frame.capture.shows.image)
            or not acts_on(self._whole, larger, frame)
        ]
        return self._loss(name, self._chosen.select.of(frames))

    @cached_property
    def _whole(self) -> Model:
        return fit(self._start, self._chosen.fit, TURNS_WITHOUT)

    def _fitted_without(self, name: str) -> Model:
        rest = fit(self._start.without_finding(name), self._chosen.fit, TURNS_WITHOUT)
        if effect(name).moves_mean:
            # Noise as wide as what is missing, or a level of each frame, is no answer.
            for term in self._whole.terms:
                if not term.effect.moves_mean and term.name != name:
                    rest = rest.with_term(term)
        return rest

    def _loss(self, name: str, frames: Likelihood) -> float:
        lost = frames.total(self._whole) - frames.total(self._rest(name))
        return lost / self._share
