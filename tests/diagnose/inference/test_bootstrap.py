# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Bootstrap: what a name may gain by what is not exact."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.bootstrap import Bootstrap
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
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
    return Bootstrap(null, Baseline(model, splits), lambda text: None), null.null


def trial_of(model, **terms):
    [name] = terms
    with_it = model.with_effect(BY_NAME[name], np.array(terms[name], float))
    return Trial(name, 20.0, np.ones(4), with_it, 20.0)


def test_a_likelihood_without_maps_is_exact():
    plain = sensor_of()
    bootstrap, model = bootstrap_of(plain)
    assert bootstrap.most_by_chance(trial_of(model, exposure=[1e-5])) == 0


def test_what_is_far_from_the_truth_gains_nothing():
    bootstrap, model = bootstrap_of(SENSOR)
    assert bootstrap.most_by_chance(trial_of(model, exposure=[0.02])) == 0


def test_what_makes_up_for_a_wrong_likelihood_gains_on_drawn_frames(monkeypatch):
    """Photons of a fifth more variance than the registry draws: less of them gains
    what another fifth of noise would, on drawn frames as on measured ones."""
    gain = prediction.photon_gain
    wrong = lambda model, frame: 1.2 * gain(model, frame)  # noqa: E731
    right, model = bootstrap_of(SENSOR)
    trial = trial_of(model, shot_noise=[-0.1])
    assert right.most_by_chance(trial) == 0
    predict_blocks = prediction._core.predict_blocks

    class Wrong:
        @staticmethod
        def predict_blocks(*given):
            mean, variance, exposed = predict_blocks(*given)
            return mean, 1.2 * variance, exposed

    monkeypatch.setattr(prediction, "_core", Wrong)
    monkeypatch.setattr(prediction, "photon_gain", wrong)
    bootstrap, model = bootstrap_of(SENSOR)
    assert bootstrap.most_by_chance(trial_of(model, shot_noise=[-0.1])) > 50


def test_captures_that_cannot_be_drawn_leave_a_name_to_its_evidence():
    bootstrap, model = bootstrap_of(SENSOR)
    bootstrap.__dict__["_drawn"] = []
    assert bootstrap.most_by_chance(trial_of(model, exposure=[1e-5])) == 0


@pytest.mark.parametrize("value", [1e-4, 1e-3])
def test_the_bound_is_small_where_the_model_is_right(value):
    """Of 49,000 pixels."""
    bootstrap, model = bootstrap_of(SENSOR)
    assert bootstrap.most_by_chance(trial_of(model, exposure=[value])) < 12
