# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Candidates: effects that a model lacks, and what each would gain.

All are screened by one step on the fit frames, or by what that gains on the select
frames; the best are fitted, and the select frames say what they gain. Of large frames a
few tiles are asked first.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, one_step
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.pruning import TURNS_WITHOUT
from cg2raw.diagnose.inference.splits import LUCK, Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

MOST_FITTED = 6  # candidates that are fitted in full, of those screened
WORTH_FITTING = 0.05  # of the best screening score
LEAST_SCORE = 2.0  # nats that screening finds, beyond one for every parameter
# Of what all tiles show, that a few have to show of it in proportion.
SHOWN_BY_FEW = 0.5


@dataclass(frozen=True)
class Screened:
    """A candidate with its first guess, and what that gains."""

    score: float
    effect: Effect
    start: Model


@dataclass(frozen=True)
class Candidates:
    """What might be added to a model.

    turns : of a candidate's fit. threshold : nats that a name gains."""

    model: Model
    effects: Sequence[Effect]
    splits: Splits
    turns: int
    threshold: float
    report: Callable[[str], None]

    @cached_property
    def null(self) -> Model:
        """The model without any, fitted as long as with one."""
        return fit(self.model, self.splits.fit, self.turns)

    @cached_property
    def current(self) -> Array:
        """The log-likelihood of the select frames without any, in blocks."""
        return self.splits.select.in_blocks(self.null)

    def trials(self, in_detail: bool = False) -> list[Trial]:
        """Screen all, fit the best; sorted by gain on the select frames, with the
        evidence for each.

        in_detail : only those that have parameters of detail, and with these: what they
        describe without may gain nothing, as the polynomial of a round lens."""
        finer = [e.in_detail for e in self.effects if e.in_detail is not None]
        screened = self._screened(finer if in_detail else self.effects)
        best = max((one.score for one in screened), default=0.0)
        found = []
        for rank, one in enumerate(screened[:MOST_FITTED]):
            chance = 0 if self._held_out(one.effect) else len(one.effect.used)
            if one.score < LEAST_SCORE + chance:
                continue
            if rank >= 3 and one.score < WORTH_FITTING * best:
                continue
            self.report(f"fitting {one.effect.name}")
            if self._is_hopeless(one):
                continue
            fitted = fit(one.start, self.splits.fit, self.turns)
            blocks = self.splits.select.in_blocks(fitted) - self.current
            found.append(Trial(one.effect.name, float(blocks.sum()), blocks, fitted))
        trials = [self._weighed(trial) for trial in found]
        return sorted(trials, key=lambda trial: trial.gain, reverse=True)

    def _screened(self, effects: Sequence[Effect]) -> list[Screened]:
        """Return the effects that frames show anything of, best first."""
        base = Linearisation(self.model, self.splits.fit)
        found = []
        for candidate in effects:
            if candidate.name in self.model.names:
                continue
            self.report(f"screening {candidate.name}")
            guess = first_guess(candidate, base)
            if guess is None:
                continue
            start, score = guess
            if self._held_out(candidate):
                score = self.splits.select.total(start) - self._height
            found.append(Screened(score, candidate, start))
        return sorted(found, key=lambda one: one.score, reverse=True)

    def _held_out(self, candidate: Effect) -> bool:
        """Return whether the select frames screen a candidate: the fit frames, which
        made the maps of a model, would rather have the noise of that again."""
        return candidate.estimator == "fixed pattern" or any(self.model.maps)

    @cached_property
    def _height(self) -> float:
        return self.splits.select.total(self.model)

    @cached_property
    def _of_few(self) -> tuple[Splits, Model] | None:
        """A few tiles, and the model fitted to them; None where frames are small."""
        few = self.splits.few
        if few is None:
            return None
        model = self.model.of_few_tiles(self.splits.frames)
        return few, fit(model, few.fit, TURNS_WITHOUT)

    def _is_hopeless(self, one: Screened) -> bool:
        """Return whether a few tiles show a candidate as well as all do, and that it
        gains too little."""
        if self._of_few is None:
            return False
        few, model = self._of_few
        share = few.select.pixels / self.splits.select.pixels
        start = one.start.of_few_tiles(self.splits.frames)
        shown = few.select if self._held_out(one.effect) else few.fit
        alone = self.model.of_few_tiles(self.splits.frames)
        if shown.total(start) - shown.total(alone) < SHOWN_BY_FEW * share * one.score:
            return False
        fitted = fit(start, few.fit, TURNS_WITHOUT)
        blocks = few.select.in_blocks(fitted) - few.select.in_blocks(model)
        most = blocks.sum() + LUCK * blocks.std() * np.sqrt(blocks.size)
        return bool(most < share * self.threshold)

    @cached_property
    def _null_gain(self) -> float:
        return null_gain(self.model, self.splits)

    def _weighed(self, trial: Trial) -> Trial:
        """Return the trial with its evidence."""
        evidence = trial.gain - self._null_gain
        if evidence < self.threshold <= 2 * trial.gain:
            evidence += null_gain(trial.model, self.splits, trial.name)
        if evidence >= self.threshold:
            told = told_by_pixels(trial.model, trial.name, self.splits.select)
            evidence = min(evidence, told)
        return replace(trial, evidence=evidence)


def told_by_pixels(model: Model, name: str, select: Likelihood) -> float:
    """Return what a model's map of variance gains for sure by the pixels that it is of,
    beyond what it does at others: that is a law of tails, and any noise has some.
    Infinite of effects that have no such map.

    Source: a permutation test; P. Good, Permutation Tests, 2000."""
    term = model.term(name)
    if term is None or term.sensor_map is None or not term.effect.whitens_variance:
        return np.inf
    elsewhere = [
        select.total(model.with_term(replace(term, sensor_map=other)))
        for other in term.sensor_map.displaced()
    ]
    most_by_chance = np.mean(elsewhere) + LUCK * np.std(elsewhere, ddof=1)
    return float(select.total(model) - most_by_chance)


def null_gain(model: Model, splits: Splits, but: str = "") -> float:
    """Return what a model gains on the select frames by fitting itself to them.

    but : name of a term that stays as it is."""
    smooth = [term for term in model.terms if term.effect.estimator == "smooth"]
    if all(term.name == but for term in smooth):
        return 0.0
    base = Linearisation(model, splits.select)
    return one_step(model, base, base.height, (but,))[1]
