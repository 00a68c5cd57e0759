# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The search: what counts as evidence for an effect beside others."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.candidates import Candidates, null_gain
from cg2raw.diagnose.inference.model_selection import Search, Trial
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import BY_NAME, ONE, captures_of, frames_of, model_of
from diagnose.shaded import SENSOR, groups_of, shaded

FAINT = 0.1  # of row noise, in read noises
FEW = ("row_noise", "read_noise", "exposure", "prnu", "heavy_tailed_noise")


def search_of(groups=((), ()), names=tuple(BY_NAME), report=lambda text: None):
    splits = Splits([*groups[0], *groups[1]], ONE)
    baseline = Baseline(Model(SENSOR), splits)
    return Search(baseline, [BY_NAME[n] for n in names], 0.01, 6, report)


@pytest.mark.parametrize(("beyond", "names"), [(-0.1, ()), (0.1, ("blur",))])
def test_an_effect_needs_the_threshold(monkeypatch, beyond, names):
    search = search_of()
    model = model_of(SENSOR, blur=[0.5, 0.0, 0.0])
    evidence = search.threshold + beyond
    trial = Trial("blur", evidence + 3, np.ones(4), model, evidence)
    monkeypatch.setattr(Search, "_select", lambda self, model: np.zeros(4))
    monkeypatch.setattr(Candidates, "trials", lambda self, in_detail=False: [trial])
    added = search._add(Model(SENSOR))
    assert tuple(added.names if added else ()) == names
    assert [step.evidence for step in search.steps] == [evidence] * len(names)


@pytest.mark.parametrize("seed", [0, 3, 5])
def test_faint_row_noise_beside_a_shading_is_found(seed):
    groups = groups_of(seed, FAINT)
    search, model = search_of(groups, FEW), shaded(groups)
    found = search._add(model)
    assert found.names == ["lens_shading", "row_noise"]
    (step,) = search.steps
    gained = null_gain(model, search.splits)
    assert step.gain - gained < search.threshold <= step.evidence
    assert step.evidence == pytest.approx(step.gain, abs=1)


@pytest.mark.slow
def test_noise_beside_a_shading_is_nothing():
    for seed in range(20, 26):
        groups = groups_of(seed)
        search = search_of(groups)
        assert search._add(shaded(groups)) is None, search.steps
        assert search.steps == []


def test_what_screening_cannot_see_is_not_fitted():
    """Of noise alone, hardly any candidate gains more than its parameters' chance."""
    words = []
    groups = groups_of(30)
    search_of(groups, report=words.append)._add(shaded(groups))
    screened, fitted = (
        sum(word.startswith(start) for word in words) for start in ("scr", "fit")
    )
    assert screened == len(BY_NAME) - 1
    assert fitted <= 4


def test_the_search_ends_when_it_stops_gaining(monkeypatch):
    """Two effects that drop each other are not added in turn until the rounds end."""
    names = iter(["exposure", "blur"] * 9)
    heights = {"exposure": 100.0, "blur": 100.1}

    def add(self, model):
        name = next(names)
        self.steps.append(name)
        return model_of(SENSOR, **{name: BY_NAME[name].null + 0.1})

    monkeypatch.setattr(Search, "_add", add)
    monkeypatch.setattr(
        Search, "_select", lambda self, model: np.array([heights[model.names[0]]])
    )
    search = search_of()
    assert search.run().names == ["exposure"]
    assert search.steps == ["exposure"]


def test_an_effect_that_was_dropped_and_comes_back_is_no_older_one():
    """It is the newest: nothing is fitted in its place."""
    darks = frames_of(SENSOR, captures_of(("dark",) * 2, exposure_time=4.0))
    search = search_of((darks, darks))
    search._given = {"dark_current": 10.0, "black_level": 10.0}
    model = model_of(SENSOR, black_level=[0.0] * 4, dark_current=[1e-4])
    assert "dark_current" not in search._sure(model, "dark_current")
