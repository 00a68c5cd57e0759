# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Bootstrap: what a name gains on captures of which the model without it is true.

Maps are estimated from few frames, light from what they show, and a likelihood is a
formula: what is not exact of these gains nats by an effect that is not there. So the
core draws the captures a few times more by the model that lacks the effect, maps are
made of them as of the measured ones, and only what an effect gains there beyond what it
gains on drawn ones counts.
Source: G. J. McLachlan, J. R. Stat. Soc. C 36(3), 1987.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.calibrated_start import calibrated_start
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.full_start import MOST_OUTLIERS
from cg2raw.diagnose.inference.outliers import without_outliers
from cg2raw.diagnose.inference.splits import LUCK, Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model

DRAWS = 4  # of all captures, by which what is not exact is known
TURNS_OF_MAPS_ANEW = 2  # with an effect, beside the maps that others have


class Bootstrap:
    """Captures drawn by the model without any of its candidates."""

    def __init__(
        self, null: Candidates, baseline: Baseline, report: Callable[[str], None]
    ) -> None:
        self._null, self._baseline, self._report = null, baseline, report

    def most_by_chance(self, trial: Trial) -> float:
        """Return the nats that a candidate may gain by its values where the model
        without it is true; 0 of models without maps, whose likelihood is exact."""
        if not any(True for _ in trial.model.maps) or not self._drawn:
            return 0.0
        gains = []
        for model, splits in self._drawn:
            with_it = trial.model.of_few_tiles(self._null.splits.frames).without_maps()
            for _ in range(TURNS_OF_MAPS_ANEW):
                with_it = fit_patterns(with_it, splits.fit)
            gains.append(splits.select.total(with_it) - splits.select.total(model))
        share = self._drawn[0][1].select.pixels / self._null.splits.select.pixels
        return max(float(np.mean(gains) + LUCK * np.std(gains, ddof=1)) / share, 0.0)

    @cached_property
    def _drawn(self) -> list[tuple[Model, Splits]]:
        """Models with the maps of drawn captures, and these."""
        return list(self._begun())

    def _begun(self) -> Iterator[tuple[Model, Splits]]:
        splits = self._null.splits.few or self._null.splits
        model = self._null.null.without_maps()
        for number in range(DRAWS):
            self._report(f"drawing captures without it, {number + 1} of {DRAWS}")
            drawn = drawn_frames(self._null.null, splits, number)
            if drawn is None:
                return
            baseline = replace(self._baseline, model=model, splits=drawn)
            start = calibrated_start(baseline, self._null.effects)
            if start is not None:
                yield start.model, start.splits
                continue
            begun = fit_patterns(model, drawn.fit)
            yield begun, without_outliers(begun, drawn, MOST_OUTLIERS)
