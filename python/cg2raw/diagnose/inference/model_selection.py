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
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.admission import Admission
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.bootstrap import Bootstrap
from cg2raw.diagnose.inference.calibrated_start import (
    calibrated_start,
    lost_without_each,
)
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.contradictions import as_finding, contradicted
from cg2raw.diagnose.inference.detail import in_detail
from cg2raw.diagnose.inference.fitting import TURNS, fit
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.full_start import MOST_OUTLIERS, Start, full_start
from cg2raw.diagnose.inference.nuisance_fit import refitted
from cg2raw.diagnose.inference.outliers import without_expected_outliers
from cg2raw.diagnose.inference.pruning import (
    TURNS_WITHOUT,
    missed_beside,
    missed_by_few,
    pruned,
    restarted,
)
from cg2raw.diagnose.inference.steps import (
    Step,
    Trial,
    calibrated_steps,
    contradicted_steps,
    mean_first,
    rule_of,
)
from cg2raw.diagnose.inference.swaps import best_swap
from cg2raw.diagnose.inference.ties import CLEAR, simplest_of_ties
from cg2raw.diagnose.inference.warmth import by_temperature
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.workers import TimeIsUp
from cg2raw.interrupts import raised

MOST_SWAPS = 3
FEW_EFFECTS = 3  # effects, up to which both ways of the search are gone
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
        self.most_outliers = 0.0  # share of a frame that is set aside
        self.light: Model | None = None  # beside which flats showed theirs
        self._light_gain = 0.0  # nats, by that
        self._reached = baseline.model
        # The profile, with maps of the same frames as those of what is found have.
        self.compared = baseline
        self._swapped: set[tuple[str, str]] = set()
        # Effects that were there before any was added, and what is lost without them.
        self._given: dict[str, float] = {}
        # The same, nats, of all effects of the model, while it is the pruned one.
        self.losses: dict[str, float] = {}
        # Nats that effects gain on captures that are drawn without them, too.
        self.refused: dict[str, float] = {}
        # Maps of what the profile states, and the same of them.
        self._mapped: dict[str, float] = {}

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
                self._run()
        except KeyboardInterrupt:
            self.interrupted = True
        except TimeIsUp:
            self.timed_out = True
        return self._reached

    def _run(self) -> None:
        """Go on from a calibrated profile, or prune what starts full, and go on from
        there; where few effects are left, go up from the baseline too, and keep what
        the select frames like better."""
        if self.most == 0:
            return  # a profile is judged as it is
        bare = self._reached
        if self._start_calibrated():
            self._climb(self._reached)
            self._name_contradicted()
            return
        if not self._start_full():
            self._climb(bare)
            return
        self._climb(self._reached)
        if not 0 < len(self._reached.found_names) <= FEW_EFFECTS:
            return
        full, steps, losses = self._reached, self.steps, self.losses
        self.steps, self._reached, self._given, self.losses = [], bare, {}, {}
        self._swapped = set()
        self._climb(bare)
        lead = float((self._select(full) - self._select(self._reached)).sum())
        if lead > CLEAR:
            self._reached, self.steps, self.losses = full, steps, losses

    def _start_calibrated(self) -> bool:
        """Take a profile that states its fixed patterns, with the maps of these."""
        start = calibrated_start(self.baseline, self.effects)
        if start is None:
            return False
        self._begin(start)
        stated = tuple(term for term in start.model.terms if term.calibration)
        self.compared = replace(self.baseline, model=replace(start.model, terms=stated))
        self._mapped = lost_without_each(start.model, start.splits.select)
        self._given = {name: self._mapped[name] for name in start.model.found_names}
        self.steps += calibrated_steps(self._given)
        return True

    def _name_contradicted(self) -> None:
        """Name maps that are not as strong as the profile says, beside which they are
        compared with what it says."""
        self.report("are fixed patterns as strong as the profile says")
        found = contradicted(self._reached, self.splits)
        may = {e.name for e in self.effects}
        found = {n: x for n, x in found.items() if n in may and x >= self.threshold}
        if not found:
            return
        said = self.compared.model
        for name in found:
            self._reached = as_finding(self._reached, name)
            said = said.without_finding(name)
        said = fit_patterns(said, self.splits.fit)
        self.compared = replace(self.compared, model=said)
        self.steps += contradicted_steps(found)

    def _start_full(self) -> bool:
        """Take all effects that uniform frames measure, and of them what is needed."""
        self.report("fitting what darks and flats show, all together")
        start = full_start(self.baseline, self.effects)
        if start is None:
            self.splits, self.most_outliers = without_expected_outliers(
                self._reached, self.splits
            )
            return False
        self._begin(start)
        model = in_detail(start.model, start.splits, self.threshold)
        left = pruned(model, start.splits, self.threshold, self.report)
        ranking = sorted(left.losses.items(), key=lambda one: -one[1])
        self.steps += calibrated_steps(dict(ranking), ranking)
        self.steps += [Step("dropped", n, -loss) for n, loss in left.dropped.items()]
        self._reached, self._given = left.model, left.losses
        self.losses = left.losses
        return True

    def _begin(self, start: Start) -> None:
        self._reached, self.splits = start.model, start.splits
        self.most_outliers = MOST_OUTLIERS
        self.light, self._light_gain = start.light, start.light_gain

    def _climb(self, model: Model) -> None:
        """Add and swap as long as the select frames gain by it."""
        height = -np.inf
        for _ in range(self.most + MOST_SWAPS):
            steps = len(self.steps)
            changed = self._add(model)
            if changed is None:
                changed = self._swap(self._reached)
            if changed is None:
                return
            before, height = height, float(self._select(changed).sum())
            if height < before + LEAST_GAIN:
                # What was added took older effects' place, and would go on doing so.
                self._reached = model
                del self.steps[steps:]
                return
            model = self._reached = changed

    def _select(self, model: Model) -> Array:
        return self.splits.select.in_blocks(model)

    def _add(self, model: Model) -> Model | None:
        """Return the model with the best candidate that passes; None if none does."""
        if len(model.found_names) - len(self._given) >= self.most:
            return None
        self.report(f"looking for effect {len(model.found_names) + 1}")
        turns = TURNS_WITHOUT if self._given else TURNS
        candidates = Candidates(
            model, self.effects, self.splits, turns, self.threshold, self.report
        )
        bootstrap = Bootstrap(candidates, self.baseline, self.alpha, self.report)
        chosen = self._chosen(candidates, bootstrap)
        chosen = chosen or self._chosen(candidates, bootstrap, in_detail=True)
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
        self, candidates: Candidates, bootstrap: Bootstrap, in_detail: bool = False
    ) -> tuple[Trial, Trial, list[str], list[Trial]] | None:
        """Return (the trial to accept, the one that comes first without a tie, names
        that are as good, all trials); None if none is sure."""
        trials = candidates.trials(in_detail)
        larger = {**self._mapped, **self._given}
        admission = Admission(candidates, self._light_gain, larger)
        sure = [trial for trial in trials if admission.admits(trial)]
        while sure:
            first = mean_first(sure, self.effects)
            best, ambiguous = simplest_of_ties(
                first, trials, self.effects, self.threshold
            )
            if not bootstrap.explains(best):
                return best, first, ambiguous, trials
            self.refused[best.name] = best.evidence
            trials = [trial for trial in trials if trial is not best]
            sure = [trial for trial in sure if trial is not best]
        return None

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
        model = by_temperature(model, self.splits)
        model = in_detail(model, self.splits, self.threshold)
        return self._pruned(model, newest)

    def _pruned(self, model: Model, newest: str) -> Model:
        """Drop older effects that are not needed any more."""
        height = self._select(model).sum()
        sure = self._sure(model, newest)
        for name in model.found_names:
            if name == newest or name in sure:
                continue
            if len(model.found_names) < 2:
                break
            self.report(f"is {name} still needed")
            rest = fit(model.without(name), self.splits.fit)
            without = self._select(rest).sum()
            if height - without < self.threshold:
                self.steps.append(Step("dropped", name, float(without - height)))
                model, height = rest, without
                self._reached = model
                continue
            model = restarted(model, name, rest, self.splits, LEAST_GAIN)
            height = self._select(model).sum()
        return model

    def _sure(self, model: Model, newest: str) -> set[str]:
        """Return which of the effects of a full start need no fit without them."""
        names = [n for n in model.found_names if n in self._given and n != newest]
        sure = missed_beside(model, self.splits, names, newest)
        left = [name for name in names if name not in sure]
        return sure | set(missed_by_few(model, self.splits, left, self.threshold))

    def _swap(self, model: Model) -> Model | None:
        """Exchange an effect for one that looks alike, if held-out frames say so."""
        if len(model.found_names) < 2 or len(self._swapped) >= MOST_SWAPS:
            return None
        # What was there from the start had no rivals: one that was better in its place
        # gains beside it, and then it is not needed any more.
        names = [name for name in model.found_names if name not in self._given]
        swap = best_swap(
            model, self.effects, self.splits, names, self._swapped, self.report
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
