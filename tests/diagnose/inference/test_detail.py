# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Detail: a lens that is not round is found so, and one that is round stays round."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.lens_shading import LensShading
from cg2raw.diagnose.inference.candidates import Candidates
from cg2raw.diagnose.inference.detail import in_detail
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    ONE,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
SHAPE = (96, 128)
THRESHOLD = 7.0
LENS = BY_NAME["lens_shading"]
ROUND = np.array([-0.2, -0.05, 0.0, 0.01, 0.0, 0.0, 0.0, *20 * [0.0]])
TURNED = {"r2_cos2": 0.05, "r5_sin1": -0.08, "r6_cos4": 0.1}
NOT_ROUND = ROUND + [TURNED.get(name, 0.0) for name in LENS.parameters]


def splits_of(values):
    kinds = ("dark", "flat", "scene", "scene")
    frames = [
        frame
        for number, group in enumerate(("fit", "select"))
        for frame in drawn(
            frames_of(SENSOR, captures_of(kinds, group, shape=SHAPE)),
            model_of(SENSOR, lens_shading=values),
            number,
        )
    ]
    return Splits(frames, ONE)


def error_of(values, splits):
    """Return the relative rms error of the light of a flat."""
    flat = splits.frames[1]
    found, true = (
        predict(model_of(SENSOR, lens_shading=one), flat).mean
        for one in (values, NOT_ROUND)
    )
    return np.std(found / true)


def test_a_lens_that_is_not_round_is_found_so():
    splits = splits_of(NOT_ROUND)
    plain = fit(model_of(SENSOR, lens_shading=ROUND), splits.fit)
    assert (plain.term("lens_shading").values[7:] == 0).all()
    found = in_detail(plain, splits, THRESHOLD).term("lens_shading")
    assert found.effect.detailed and len(found.effect.used) == 27
    assert error_of(found.values, splits) < 0.3 * error_of(
        plain.term("lens_shading").values, splits
    )


@pytest.mark.parametrize("detailed", [False, True])
def test_a_lens_that_needs_no_more_stays_as_it_is(detailed):
    splits = splits_of(NOT_ROUND if detailed else ROUND)
    effect = LENS.in_detail if detailed else LENS
    values = NOT_ROUND if detailed else ROUND
    model = Model(SENSOR).with_effect(effect, values)
    assert in_detail(model, splits, THRESHOLD) is model


def test_a_profile_that_is_right_but_for_detail_lacks_it():
    """The polynomial of a round lens gains nothing beside a profile that has it."""
    names = LENS.parameters[:7]
    listed = dict(zip(names, map(float, ROUND[:7]), strict=True))
    sensor = sensor_of(effects=[{"name": "lens_shading", "parameters": listed}])
    splits = splits_of(NOT_ROUND)
    candidates = Candidates(Model(sensor), [LENS], splits, 1, THRESHOLD, lambda _: None)
    gains = [trial.evidence for trial in candidates.trials()]
    [trial] = candidates.trials(in_detail=True)
    assert trial.name == "lens_shading"
    assert trial.evidence > 2 * max(gains, default=0) + 100
    found = trial.model.term("lens_shading").values
    assert error_of(ROUND + found, splits) < 0.3 * error_of(ROUND, splits)


def test_detail_that_is_not_used_costs_nothing():
    assert LENS.used == list(LENS.parameters[:7])
    assert LENS.in_detail.used == list(LENS.parameters)


def test_derivatives_in_proportion_are_those_by_differences(monkeypatch):
    splits = splits_of(NOT_ROUND)
    model = Model(SENSOR).with_effect(LENS.in_detail, NOT_ROUND)
    likelihood = on(splits.frames[:4])
    names, score, told = Linearisation(model, likelihood).system(model)
    monkeypatch.setattr(LensShading, "in_proportion", lambda *_: None)
    same, expected, by_differences = Linearisation(model, likelihood).system(model)
    assert names == same and len(names) == 27
    sigma = np.sqrt(np.diag(by_differences))
    np.testing.assert_allclose(score / sigma, expected / sigma, atol=1e-3)
    away = (told - by_differences) / np.outer(sigma, sigma)
    assert np.abs(away).max() < 1e-4
