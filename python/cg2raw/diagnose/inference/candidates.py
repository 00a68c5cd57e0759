# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Candidates: effects that a model lacks, and what each would gain.

All are screened by one step on the fit frames; the best are fitted, and the select
frames say what they gain.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, one_step
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model

MOST_FITTED = 6  # candidates that are fitted in full, of those screened
WORTH_FITTING = 0.05  # of the best screening score
LEAST_SCORE = 2.0  # nats that screening finds, beyond one for every parameter
# Of what all tiles show, that a few have to show of it in proportion.


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
            if one.score < LEAST_SCORE + len(one.effect.used):
                continue
            if rank >= 3 and one.score < WORTH_FITTING * best:
                continue
            self.report(f"fitting {one.effect.name}")
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
            found.append(Screened(score, candidate, start))
        return sorted(found, key=lambda one: one.score, reverse=True)

    @cached_property
    def _null_gain(self) -> float:
        return null_gain(self.model, self.splits)

    def _weighed(self, trial: Trial) -> Trial:
        """Return the trial with its evidence."""
        evidence = trial.gain - self._null_gain
        if evidence < self.threshold <= 2 * trial.gain:
            evidence += null_gain(trial.model, self.splits, trial.name)
        return replace(trial, evidence=evidence)


def null_gain(model: Model, splits: Splits, but: str = "") -> float:
    """Return what a model gains on the select frames by fitting itself to them.

    but : name of a term that stays as it is."""
    smooth = [term for term in model.terms if term.effect.estimator == "smooth"]
    if all(term.name == but for term in smooth):
        return 0.0
    base = Linearisation(model, splits.select)
    return one_step(model, base, base.height, (but,))[1]
