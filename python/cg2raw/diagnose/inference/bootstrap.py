# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Bootstrap: what a name gains on captures of which the model without it is true.

Maps are estimated from few frames, light from what they show, and a likelihood is a
formula: what is not exact of these gains nats by an effect that is not there. So the
core draws the captures a few times more by the model that lacks the effect, maps are
made of them as of the measured ones, and an effect has to gain more than it does there.
Source: G. J. McLachlan, J. R. Stat. Soc. C 36(3), 1987.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import t

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.calibrated_start import calibrated_start
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.full_start import MOST_OUTLIERS
from cg2raw.diagnose.inference.outliers import without_outliers
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model

FEWEST_DRAWS, MOST_DRAWS = 2, 12  # of all captures
TURNS_OF_DRAWN = 2  # with a candidate, and without it


@dataclass(frozen=True)
class _Drawn:
    """Captures that were drawn: where a search of them begins, the same with maps that
    are made of them, and they."""

    begun: Model
    null: Model
    splits: Splits


class Bootstrap:
    """Captures drawn by the model without any of its candidates.

    alpha : chance that a candidate which gains as on drawn ones is not found out."""

    def __init__(
        self,
        null: Candidates,
        baseline: Baseline,
        alpha: float,
        report: Callable[[str], None],
    ) -> None:
        self._null, self._baseline, self._alpha = null, baseline, alpha
        self._report = report
        self._drawn: list[_Drawn] = []

    def explains(self, trial: Trial) -> bool:
        """Return whether a candidate's gain may be one of drawn captures, by the
        interval that holds another one: as many are drawn as it takes to know. False of
        models without maps, whose likelihood is exact.

        Source of the interval: G. J. Hahn, J. Am. Stat. Assoc. 64, 1969."""
        gains: list[float] = []
        least = trial.evidence - self._null.threshold
        if not list(trial.model.maps):
            return False
        while len(gains) < MOST_DRAWS:
            drawn = self._draw(len(gains))
            if drawn is None:
                return False
            gains.append(max(self._gain(trial, drawn), 0.0))  # or nobody would add it
            if len(gains) < FEWEST_DRAWS:
                continue
            if least > most_of_next(gains, self._alpha):
                return False
            if least < np.mean(gains):
                return True
        return True

    def _gain(self, trial: Trial, drawn: _Drawn) -> float:
        """Return the nats that a candidate gains on drawn captures by its values,
        scaled to as many pixels as there are. Maps go on from those of the model
        without it, as in the search: what differs else is not the candidate's."""
        model = drawn.begun
        for term in trial.model.terms:
            is_map = isinstance(term.effect, FixedPattern)
            if not is_map or model.term(term.name) is None:
                model = model.with_term(replace(term, sensor_map=None))
        with_it = _with_maps(model, drawn.splits)
        select, pixels = drawn.splits.select, self._null.splits.select.pixels
        gain = select.total(with_it) - select.total(drawn.null)
        return gain * pixels / select.pixels

    def _draw(self, number: int) -> _Drawn | None:
        """Return captures that are drawn, begun as a search begins; None if they cannot
        be drawn."""
        if number < len(self._drawn):
            return self._drawn[number]
        self._report(f"drawing captures without it, set {number + 1}")
        null = self._null.null
        splits = self._null.splits.few or self._null.splits
        drawn = drawn_frames(null, splits, number)
        if drawn is None:
            return None
        model = null.without_maps()
        baseline = replace(self._baseline, model=model, splits=drawn)
        start = calibrated_start(baseline, self._null.effects)
        if start is None:
            begun = fit_patterns(model, drawn.fit)
            shown = without_outliers(begun, drawn, MOST_OUTLIERS)
        else:
            begun, shown = start.model, start.splits
        self._drawn.append(_Drawn(begun, _with_maps(begun, shown), shown))
        return self._drawn[number]


def _with_maps(model: Model, splits: Splits) -> Model:
    """Return a model with maps that have settled beside what it has."""
    for _ in range(TURNS_OF_DRAWN):
        model = fit_patterns(model, splits.fit)
    return model


def most_of_next(gains: Sequence[float], alpha: float) -> float:
    """Return what one more gain does not exceed, but with a chance of alpha, if gains
    are normal; 0 at least."""
    count, spread = len(gains), np.std(gains, ddof=1)
    far = t.ppf(1 - alpha, count - 1) * np.sqrt(1 + 1 / count)
    return float(max(np.mean(gains) + far * spread, 0.0))
