# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Model selection: effects are added one by one, each on frames that did not fit it.

A candidate is screened by one step on the fit frames, fitted there by maximum
likelihood, and accepted if the likelihood of the select frames rises by
ln(candidates / alpha) over the best that the model without it can do there: the split
likelihood-ratio test. Where that alone is not enough, the parameters that both models
share may move on the select frames on either side, and the candidate's own may not: the
profile likelihood of what the fit frames said. Source: L. Wasserman, A. Ramdas, S.
Balakrishnan, Universal inference, PNAS 117(29), 2020.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.detail import in_detail
from cg2raw.diagnose.inference.fitting import TURNS, fit
from cg2raw.diagnose.inference.nuisance_fit import refitted
from cg2raw.diagnose.inference.steps import Step, Trial, mean_first, rule_of
from cg2raw.diagnose.inference.swaps import best_swap
from cg2raw.diagnose.inference.ties import CLEAR, simplest_of_ties
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.workers import TimeIsUp
from cg2raw.interrupts import raised

MOST_SWAPS = 3
LEAST_GAIN = 0.3  # nats, of a change after all that depends on it was looked at again


class Search:
    """The state of one search; run() goes on until nothing more is accepted.

    report : is called with every step. steps : what changed the model."""

    def __init__(
        self,
        baseline: Baseline,
        effects: Sequence[Effect],
        alpha: float,
        most: int,
        report: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.baseline, self.effects = baseline, effects
        self.alpha, self.most, self.report = alpha, most, report
        self.splits = baseline.splits
        self.steps: list[Step] = []
        self.interrupted = baseline.ended is KeyboardInterrupt
        self.timed_out = baseline.ended is TimeIsUp
        self._reached = baseline.model
        self._swapped: set[tuple[str, str]] = set()

    @property
    def threshold(self) -> float:
        """Nats that a name must gain."""
        return float(np.log(max(len(self.effects), 1) / self.alpha))

    def run(self) -> Model:
        """Return the baseline with all effects that are accepted. Ctrl-C and the
        workers' deadline end the search with what was accepted until then."""
        if self.baseline.ended:
            return self._reached
        try:
            with raised():
                self._climb()
        except KeyboardInterrupt:
            self.interrupted = True
        except TimeIsUp:
            self.timed_out = True
        return self._reached

    def _climb(self) -> None:
        """Add and swap as long as the select frames gain by it."""
        if self.most == 0:
            return  # a profile is judged as it is
        model, height = self._reached, -np.inf
        for _ in range(self.most + MOST_SWAPS):
            steps = len(self.steps)
            changed = self._add(model)
            if changed is None:
                changed = self._swap(self._reached)
            if changed is None:
                return
            before, height = height, self.splits.select.total(changed)
            if height < before + LEAST_GAIN:
                # What was added took older effects' place, and would go on doing so.
                self._reached = model
                del self.steps[steps:]
                return
            model = self._reached = changed

    def _add(self, model: Model) -> Model | None:
        """Return the model with the best candidate that passes; None if none does."""
        if len(model.found_names) >= self.most:
            return None
        self.report(f"looking for effect {len(model.found_names) + 1}")
        candidates = Candidates(
            model, self.effects, self.splits, TURNS, self.threshold, self.report
        )
        chosen = self._chosen(candidates) or self._chosen(candidates, in_detail=True)
        if chosen is None:
            self._reached = candidates.null
            return None
        best, first, ambiguous, trials = chosen
        self.steps.append(
            Step(
                "added",
                best.name,
                best.gain,
                best.evidence,
                [(t.name, t.gain) for t in trials],
                ambiguous,
                rule_of(best, first, trials),
            )
        )
        self._reached = best.model
        return self._settled(best.model, best.name)

    def _chosen(
        self, candidates: Candidates, in_detail: bool = False
    ) -> tuple[Trial, Trial, list[str], list[Trial]] | None:
        """Return (the trial to accept, the one that comes first without a tie, names
        that are as good, all trials); None if none is sure."""
        trials = candidates.trials(in_detail)
        sure = [trial for trial in trials if trial.evidence >= self.threshold]
        if not sure:
            return None
        first = mean_first(sure, self.effects)
        best, ambiguous = simplest_of_ties(first, trials, self.effects, self.threshold)
        return best, first, ambiguous, trials

    def _settled(self, model: Model, newest: str) -> Model:
        """Return the model after all that depends on it was looked at again."""
        registration = self.baseline.registration
        if registration is not None:
            self.report("aligning again")
            registration.again(model, self.splits.frames)
            self.splits = self.splits.placed(registration)
        if model.nuisance is not None:
            better = refitted(model, self.splits.of_nuisances)
            model = fit(replace(model, nuisance=better), self.splits.fit)
        model = in_detail(model, self.splits, self.threshold)
        return self._pruned(model, newest)

    def _pruned(self, model: Model, newest: str) -> Model:
        """Drop older effects that are not needed any more."""
        height = self.splits.select.total(model)
        for name in model.found_names:
            if name == newest or len(model.found_names) < 2:
                continue
            self.report(f"is {name} still needed")
            rest = fit(model.without(name), self.splits.fit)
            without = self.splits.select.total(rest)
            if height - without < self.threshold:
                self.steps.append(Step("dropped", name, without - height))
                model, height = rest, without
                self._reached = model
        return model

    def _swap(self, model: Model) -> Model | None:
        """Exchange an effect for one that looks alike, if held-out frames say so."""
        if len(model.found_names) < 2 or len(self._swapped) >= MOST_SWAPS:
            return None
        swap = best_swap(
            model,
            self.effects,
            self.splits,
            model.found_names,
            self._swapped,
            self.report,
        )
        if swap is None or swap.gain <= CLEAR:
            return None
        self._swapped.add((swap.old, swap.new))
        gain, rivals = swap.gain, [(swap.old, 0.0)]
        rule = f"With the other effects it explains {gain:.1f} nats more than "
        rule += f"{swap.old}."
        self.steps.append(Step("swapped", swap.new, gain, gain, rivals, rule=rule))
        self._reached = swap.model
        return self._settled(swap.model, swap.new)
