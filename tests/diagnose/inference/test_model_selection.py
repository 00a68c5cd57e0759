# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The search: what counts as evidence for an effect beside others."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.model_selection import Search, Trial
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import BY_NAME, ONE, model_of
from diagnose.shaded import SENSOR, groups_of, shaded

SEARCHED = [n for n, effect in BY_NAME.items() if effect.estimator != "stated"]


def search_of(groups=((), ()), names=SEARCHED, report=lambda text: None):
    splits = Splits([*groups[0], *groups[1]], ONE)
    baseline = Baseline(Model(SENSOR), splits)
    return Search(baseline, [BY_NAME[n] for n in names], 0.01, 6, report)


@pytest.mark.parametrize(("beyond", "names"), [(-0.1, ()), (0.1, ("blur",))])
def test_an_effect_needs_the_threshold(monkeypatch, beyond, names):
    search = search_of()
    model = model_of(SENSOR, blur=[0.5, 0.0, 0.0])
    evidence = search.threshold + beyond
    trial = Trial("blur", evidence + 3, np.ones(4), model, evidence)
    monkeypatch.setattr(Likelihood, "total", lambda self, model, known=None: 0.0)
    monkeypatch.setattr(Candidates, "trials", lambda self, in_detail=False: [trial])
    added = search._add(Model(SENSOR))
    assert tuple(added.names if added else ()) == names
    assert [step.evidence for step in search.steps] == [evidence] * len(names)


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
    assert screened == len(SEARCHED) - 1
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
        Likelihood, "total", lambda self, model, known=None: heights[model.names[0]]
    )
    search = search_of()
    assert search.run().names == ["exposure"]
    assert search.steps == ["exposure"]
