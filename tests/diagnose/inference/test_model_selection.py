# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The search: what counts as evidence for an effect beside others."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.model_selection import Search, Trial
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    BY_NAME,
    ONE,
    READ,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
SHADING = {"lens_shading": [0.0, -0.3, -0.3, -0.3, 0.0, 0.0, 0.0]}
FAINT = 0.1  # of row noise, in read noises
FEW = ("row_noise", "read_noise", "exposure", "prnu", "heavy_tailed_noise")


def groups_of(seed, sigma=0.0):
    """Return frames to fit and to select on, with a shading and row noise."""

    def rows(frame, rng):
        return sigma * READ * rng.standard_normal((1, frame.tiles.size[0], 1))

    result = []
    for number, group in enumerate(("fit", "select")):
        captures = [
            capture_of(kind, 10 * number + n, name=f"{kind}{n}{group}", group=group)
            for n in range(2)
            for kind in ("dark", "flat", "scene")
        ]
        frames = frames_of(SENSOR, captures)
        result.append(drawn(frames, model_of(SENSOR, **SHADING), [seed, number], rows))
    return result


def search_of(groups=((), ()), names=tuple(BY_NAME), report=lambda text: None):
    splits = Splits([*groups[0], *groups[1]], ONE)
    baseline = Baseline(Model(SENSOR), splits)
    return Search(baseline, [BY_NAME[n] for n in names], 0.01, 6, report)


def shaded(groups):
    """Return the model that knows the shading, fitted."""
    return fit(model_of(SENSOR, **SHADING), on(groups[0]))


def weighed(monkeypatch, gain, null_gain, own=0.0):
    """Return (evidence over the threshold, models whose own gain was asked for)."""
    asked = []

    def gain_of(self, model, but=""):
        asked.append((model, but))
        return own

    monkeypatch.setattr(Search, "_null_gain", gain_of)
    search = search_of()
    trial = Trial("blur", search.threshold + gain, np.zeros(1), Model(SENSOR))
    return search._weighed(trial, null_gain).evidence - search.threshold, asked


def test_strict_evidence_suffices(monkeypatch):
    evidence, asked = weighed(monkeypatch, gain=5.0, null_gain=4.0, own=9.0)
    assert evidence == pytest.approx(1) and not asked


@pytest.mark.parametrize("gain", [3.0, -3.0])
def test_what_both_share_may_move_on_both_sides(monkeypatch, gain):
    evidence, asked = weighed(monkeypatch, gain, null_gain=4.0, own=6.5)
    assert evidence == pytest.approx(gain - 4 + 6.5)
    assert asked == [(Model(SENSOR), "blur")]


def test_too_small_a_gain_is_not_helped(monkeypatch):
    evidence, asked = weighed(monkeypatch, gain=-6.0, null_gain=0.0, own=100.0)
    assert evidence == pytest.approx(-6) and not asked


@pytest.mark.parametrize(("own", "names"), [(2.4, ()), (2.6, ("blur",))])
def test_an_effect_needs_the_threshold(monkeypatch, own, names):
    """blur gains 0.5 nats more than that, of which the model alone gains 3."""
    search = search_of()
    model = model_of(SENSOR, blur=[0.5, 0.0, 0.0])
    trial = Trial("blur", search.threshold + 0.5, np.ones(4), model)
    monkeypatch.setattr(Search, "_select", lambda self, model: np.zeros(4))
    monkeypatch.setattr(Search, "_trials", lambda self, model, current: [trial])
    monkeypatch.setattr(Search, "_null_gain", lambda self, m, but="": own if but else 3)
    added = search._add(Model(SENSOR))
    assert tuple(added.names if added else ()) == names
    assert [step.evidence for step in search.steps] == pytest.approx(
        [search.threshold + 0.1] * len(names)
    )


def test_parameters_gain_one_nat_each_by_chance():
    """Half a nat for their error on the frames that they were fitted to, and half for
    what is best on the others: chi-square of 7, of 12 sets of frames."""
    gains = []
    for seed in range(12):
        groups = groups_of(seed)
        gains.append(search_of(groups)._null_gain(shaded(groups)))
    assert np.mean(gains) == pytest.approx(7, abs=3 * np.sqrt(14 / 12))


def test_a_term_that_rests_gains_nothing():
    groups = groups_of(1)
    search, model = search_of(groups), shaded(groups)
    both = fit(model_of(SENSOR, **SHADING, exposure=[0.0]), on(groups[0]))
    assert search._null_gain(model, "lens_shading") == 0
    assert search._null_gain(model_of(SENSOR, row_noise=[0.1])) == 0
    rested = [search._null_gain(both, but) for but in ("lens_shading", "exposure", "")]
    assert 0 <= rested[0] < rested[1] <= rested[2] + 0.1


@pytest.mark.parametrize("seed", [0, 3, 5])
def test_faint_row_noise_beside_a_shading_is_found(seed):
    groups = groups_of(seed, FAINT)
    search, model = search_of(groups, FEW), shaded(groups)
    found = search._add(model)
    assert found.names == ["lens_shading", "row_noise"]
    (step,) = search.steps
    null_gain = search._null_gain(model)
    assert step.gain - null_gain < search.threshold <= step.evidence
    assert step.evidence == pytest.approx(step.gain, abs=1)


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
