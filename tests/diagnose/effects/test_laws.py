# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Laws that every effect's file keeps: words, whitening, density, fit, way back."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.assessment.updated_profile import updated_profile
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.catalogue import every, names
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.intervals import estimates
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import BY_NAME, capture_of, drawn, frames_of, on, sensor_of

SENSOR = sensor_of()
WHITENING = [
    one.name
    for one in every().values()
    if one.whitening and one.estimator != "fixed pattern"
]
# Values that a handful of small frames show by far, and are in the middle of a range.
PLANTED = {
    "exposure": (0.05,),
    "white_balance": (0.05, -0.04),
    "color_matrix": (0.04, -0.02, 0.03, 0.02, -0.03, 0.02),
    "blur": (0.1, 0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    "color_shading": (0.06, 0.0, 0.0, 0.0, -0.05, 0.0, 0.0, 0.0),
    "lateral_chromatic_aberration": (0.5, -0.4, 0.0, 0.0),
    "lens_shading": (-0.2, -0.05, 0.0, 0.01, 0.0, 0.0, 0.0, *20 * (0.0,)),
    "veiling_glare": (0.03, 0.02),
    "crosstalk": (0.01, 0.02, 0.015, 0.01),
    "gr_gb_imbalance": (0.02, -0.01),
    "nonlinearity": (0.06, 0.02),
    "full_well": (0.55,),
    "black_level": (0.002, -0.001, 0.003, 0.001),
    "shot_noise": (0.4,),
    "read_noise": (0.5,),
}


@pytest.fixture(scope="module")
def frames():
    kinds = ("dark", "flat", "scene", "scene")
    captures = [capture_of(kind, n, level=0.7) for n, kind in enumerate(kinds)]
    return frames_of(SENSOR, captures)


def null_like(effect):
    """Return values that are as good as none of an effect."""
    return np.maximum(effect.null, effect.low)


@pytest.mark.parametrize("name", names())
def test_its_words_exist(name):
    effect = every()[name]
    assert effect.title and effect.where
    assert not effect.title.endswith(".") and not effect.where.endswith(".")
    one = Estimate(0.1, "1", (0.05, 0.15))
    size = effect.size(dict.fromkeys(effect.parameters, one))
    assert any(letter.isdigit() for letter in size) and not size.endswith(".")
    assert effect.signature <= {"gain", "mixer", "softener", "offset", "noise", "map"}
    assert set(effect.taken_up_by) <= set(names()) - {name}
    assert set(effect.switches) <= set(effect.parameters)
    assert effect.needs <= {"light", "level", "levels", "repeats", "image", "time"}


@pytest.mark.parametrize("name", WHITENING)
def test_its_whitening_of_a_null_model_is_the_identity(frames, name):
    effect = every()[name]
    rng = np.random.default_rng(1)
    for frame in frames:
        p = predict(Model(SENSOR), frame)
        z = rng.standard_normal(p.mean.shape)
        white, cost = effect.whiten(z, p, null_like(effect), frame, frame.beta2)
        # Tails begin at their least share; a filter keeps 1e-4 of every frequency.
        assert white == pytest.approx(z, abs=5e-3)
        assert np.broadcast_to(cost, z.shape) == pytest.approx(0, abs=5e-3)


STRONG = {
    "full_well": (0.68,),
    "noise_reduction": (0.3, 0.05),
    "row_noise": (0.7,),
    "black_level_drift": (0.4,),
    "read_noise_correlation": (0.4,),
    "mains_flicker": (0.2, 5.0),
    "poisson_shot_noise": (1.0,),
    "heavy_tailed_noise": (0.05, 12.0),
}


LINEAR = [name for name in WHITENING if every()[name].linear]
SHAPE = (1, 8, 8)


def uniform(name):
    """Return a frame and a prediction that are the same at all pixels."""
    (frame,) = frames_of(SENSOR, [capture_of("flat", shape=SHAPE[1:])])
    frame = replace(frame, keep=np.ones(SHAPE, bool))
    level = {"full_well": 0.3, "read_noise_correlation": 5e-4}.get(name, 0.05)
    variance = frame.beta1 * level + frame.beta2
    full = (np.broadcast_to(x, SHAPE) for x in (level, variance, level, variance))
    return frame, Prediction(*(np.array(x) for x in full))


@pytest.mark.parametrize("name", [name for name in WHITENING if name not in LINEAR])
def test_its_density_integrates_to_one(name):
    """Of one pixel, over all that its residual may be."""
    frame, p = uniform(name)
    grid = np.linspace(-9, 9, 3601)
    heights = []
    for value in grid:
        z, values = np.full(SHAPE, value), np.array(STRONG[name])
        white, cost = every()[name].whiten(z, p, values, frame, frame.beta2)
        log = -0.5 * white**2 - 0.5 * np.log(2 * np.pi) + cost
        heights.append(log[0, 4, 4])
    assert np.trapezoid(np.exp(heights), grid) == pytest.approx(1, abs=3e-3)


@pytest.mark.parametrize("name", LINEAR)
def test_its_cost_is_the_determinant_of_its_whitening(name):
    """Of a linear map of all pixels: then their joint density integrates to one."""
    frame, p = uniform(name)
    values, columns = np.array(STRONG[name]), []
    for unit in np.eye(np.prod(SHAPE)):
        z = unit.reshape(SHAPE)
        white, cost = every()[name].whiten(z, p, values, frame, frame.beta2)
        columns.append(white.ravel())
    determinant = np.linalg.slogdet(np.array(columns))[1]
    assert np.broadcast_to(cost, SHAPE).sum() == pytest.approx(determinant, abs=1e-8)
    assert determinant != 0


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_value_is_recovered(frames, name):
    effect = BY_NAME[name]
    values = np.array(PLANTED[name], float)
    assert len(values) == len(effect.parameters)
    shown = on(drawn(frames, Model(SENSOR).with_effect(effect, values), 7))
    base = Linearisation(Model(SENSOR), shown)
    start, _ = first_guess(effect, base)
    found = fit(start, shown)
    true = Model(SENSOR).with_effect(effect, values)
    assert shown.total(found) > shown.total(true) - 2
    of_effect = estimates(found, shown)[name]
    assert list(of_effect) == [p for p in effect.parameters if p in effect.used]
    for parameter, value in zip(effect.parameters, values, strict=True):
        if parameter not in effect.used:
            continue
        one = of_effect[parameter]
        half = (one.ci95[1] - one.ci95[0]) / 2
        assert abs(one.value - value) < 2.2 * half + 1e-9, parameter


@pytest.mark.parametrize("name", [name for name in PLANTED if name not in WHITENING])
def test_its_entry_in_a_profile_simulates_what_it_predicted(frames, name):
    effect = BY_NAME[name]
    model = Model(SENSOR).with_effect(effect, np.array(PLANTED[name], float))
    values = {
        name: {
            parameter: Estimate(float(value), "1", (0.0, 1.0))
            for parameter, value in zip(effect.parameters, PLANTED[name], strict=True)
        }
    }
    text = updated_profile(model, frames, [], values)
    again = frames_of(Sensor.from_json(text, name), [f.capture for f in frames])
    for frame, other in zip(frames, again, strict=True):
        expected = predict(model, frame)
        found = predict(Model(Sensor.from_json(text, name)), other)
        assert found.mean == pytest.approx(expected.mean, abs=1e-6)
        assert found.variance == pytest.approx(expected.variance, rel=1e-4)
