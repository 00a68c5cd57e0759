# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Bootstrap: what a name may gain by what is not exact."""

import numpy as np
import pytest

from cg2raw.diagnose.inference import bootstrap as module
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.bootstrap import Bootstrap, most_of_next
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.model_selection import Search
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood import prediction
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import BY_NAME, ONE, captures_of, frames_of, sensor_of

PATTERN = {"name": "prnu", "parameters": {"sigma": 0.01}}
SENSOR = sensor_of(effects=[PATTERN])
KINDS = ("flat",) * 4


def bootstrap_of(sensor):
    """Return (bootstrap, its null model) of captures that are of the sensor."""
    captures = captures_of(KINDS, "fit", level=0.6)
    captures += captures_of(KINDS, "select", level=0.6)
    splits = Splits(frames_of(sensor, captures), ONE)
    splits = drawn_frames(Model(sensor), splits, 9)
    model = Model(sensor)
    if sensor.effects:
        model = fit_patterns(model.with_effect(BY_NAME["prnu"]), splits.fit)
    effects = [BY_NAME["exposure"], BY_NAME["read_noise"]]
    null = Candidates(model, effects, splits, 1, 8.0, lambda text: None)
    baseline = Baseline(model, splits)
    return Bootstrap(null, baseline, 0.01, lambda text: None), null.null


def trial_of(model, evidence=20.0, **terms):
    [name] = terms
    with_it = model.with_effect(BY_NAME[name], np.array(terms[name], float))
    return Trial(name, evidence, np.ones(4), with_it, evidence)


def test_a_likelihood_without_maps_is_exact(monkeypatch):
    plain = sensor_of()
    bootstrap, model = bootstrap_of(plain)
    monkeypatch.setattr(bootstrap, "_draw", None)  # none are asked for
    assert not bootstrap.explains(trial_of(model, exposure=[1e-5]))


@pytest.mark.parametrize("value", [1e-4, 1e-3, 0.02])
def test_where_the_likelihood_is_right_it_explains_nothing(value):
    bootstrap, model = bootstrap_of(SENSOR)
    assert not bootstrap.explains(trial_of(model, exposure=[value]))


def test_what_makes_up_for_a_wrong_likelihood_gains_on_drawn_frames(monkeypatch):
    """A variance of a fifth more than the registry draws: less light's noise gains
    a hundred nats, on drawn frames as on measured ones."""
    bootstrap, model = bootstrap_of(SENSOR)
    trial = trial_of(model, evidence=100.0, shot_noise=[-0.1])
    assert not bootstrap.explains(trial)
    gain, predict_blocks = prediction.photon_gain, prediction._core.predict_blocks

    class Wrong:
        @staticmethod
        def predict_blocks(*given):
            mean, variance, exposed = predict_blocks(*given)
            return mean, 1.2 * variance, exposed

    monkeypatch.setattr(prediction, "_core", Wrong)
    monkeypatch.setattr(prediction, "photon_gain", lambda *given: 1.2 * gain(*given))
    bootstrap, model = bootstrap_of(SENSOR)
    assert bootstrap.explains(trial_of(model, evidence=100.0, shot_noise=[-0.1]))
    assert not bootstrap.explains(trial_of(model, evidence=3e4, shot_noise=[-0.1]))


def test_how_much_it_loses_on_drawn_frames_says_nothing(monkeypatch):
    """Nobody would add what loses: its losses are no spread of what it gains."""
    bootstrap, model = bootstrap_of(SENSOR)
    lost = iter([-5.0, -485.0])
    monkeypatch.setattr(bootstrap, "_gain", lambda *given: next(lost))
    assert not bootstrap.explains(trial_of(model, evidence=158.0, exposure=[1e-3]))


def test_captures_that_cannot_be_drawn_leave_a_name_to_its_evidence(monkeypatch):
    bootstrap, model = bootstrap_of(SENSOR)
    monkeypatch.setattr(module, "drawn_frames", lambda *given: None)
    assert not bootstrap.explains(trial_of(model, exposure=[1e-5]))


def test_more_draws_are_surer():
    """Of gains about 10 with a spread of 2: the interval of Student's t."""
    rng = np.random.default_rng(1)
    for count, far in ((2, 39.0), (4, 5.1), (6, 3.6)):
        gains = rng.normal(10, 2, count)
        expected = gains.mean() + far * gains.std(ddof=1)
        assert most_of_next(gains, 0.01) == pytest.approx(expected, rel=0.02)
    held = [
        most_of_next(draws[:4], 0.05) > draws[4]
        for draws in rng.normal(10, 2, (4000, 5))
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=0.012)
    assert most_of_next([-50.0, -51.0, -49.0], 0.01) == 0


def test_a_search_names_nothing_that_drawn_captures_explain(monkeypatch):
    """The name is kept with what it gains, for the report."""
    bootstrap, model = bootstrap_of(SENSOR)
    monkeypatch.setattr(Bootstrap, "explains", lambda *given: True)
    null = bootstrap._null
    trial = trial_of(model, exposure=[1e-3])
    monkeypatch.setattr(Candidates, "trials", lambda self, in_detail=False: [trial])
    search = Search(bootstrap._baseline, null.effects, 0.01, 6)
    assert search._add(model) is None
    assert search.refused == {"exposure": 20.0}
