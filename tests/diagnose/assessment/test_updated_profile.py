# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The found profile loads, and says what was found on top of what it said."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.assessment.updated_profile import updated_profile
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    bare,
    capture_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

SENSOR = sensor_of()
SMOOTH = [
    name
    for name, effect in BY_NAME.items()
    if effect.estimator == "smooth" and name not in ("shot_noise", "read_noise")
]
OLD = {
    "name": "lens_shading",
    "parameters": {
        **{"r2": -0.3, "r4": -0.1, "r6": 0.05, "tilt_x": 0.02, "tilt_y": 0.01},
        **{"tilt_x_r2": 0.0, "tilt_y_r2": 0.0},
    },
}


@pytest.fixture(scope="module")
def frames():
    return frames_of(SENSOR, [capture_of("dark", 1), capture_of("scene", 2)])


def estimates_of(model):
    """Return values as estimates, in the registry's units."""
    return {
        term.name: {
            parameter: Estimate(float(value), "1", (float(value) - 1, float(value) + 1))
            for parameter, value in zip(
                term.effect.parameters, term.values, strict=True
            )
            if parameter in term.effect.used
        }
        for term in model.terms
    }


def profile_of(model, frames):
    text = updated_profile(model, frames, [], estimates_of(model))
    return Sensor.from_json(text, "found"), json.loads(text)


def values_for(name):
    effect = BY_NAME[name]
    spread = np.minimum(0.02 + 0.01 * np.arange(len(effect.low)), effect.high)
    values = np.clip(spread * (-1) ** np.arange(len(spread)), effect.low, None)
    used = [parameter in effect.used for parameter in effect.parameters]
    return np.where(used, values, 0.0)


@pytest.mark.parametrize("name", [*SMOOTH, "noise_reduction"])
def test_every_smooth_effect_predicts_what_the_model_did(frames, name):
    """The found profile alone is the doubted one with the term."""
    model = model_of(SENSOR, **{name: values_for(name)})
    sensor, _ = profile_of(model, frames)
    for frame in frames:
        expected, found = predict(model, frame), predict(Model(sensor), frame)
        assert found.mean == pytest.approx(expected.mean, abs=1e-6)
        assert found.variance == pytest.approx(expected.variance, rel=1e-4)


def test_found_values_are_added_to_the_old(frames):
    sensor = sensor_of(effects=[OLD])
    new = np.array([-0.1, 0.02, 0.0, 0.01, 0.0, 0.0, 0.03])
    model = model_of(sensor, lens_shading=new)
    found, text = profile_of(model, frames)
    (effect,) = text["effects"]
    names = BY_NAME["lens_shading"].parameters
    assert sorted(effect["parameters"]) == sorted(OLD["parameters"])
    for name, value in zip(names, new, strict=False):
        expected = OLD["parameters"][name] + value
        assert effect["parameters"][name] == pytest.approx(expected)
    frame = frames[1]
    assert predict(Model(found), frame).mean == pytest.approx(
        predict(model, frame).mean, abs=1e-6
    )


def test_a_sum_beyond_the_bounds_stays_within_them(frames):
    """The profile's and the found value are each in bounds; searches try such sums."""
    low = float(BY_NAME["lens_shading"].low[0])
    extreme = {**OLD, "parameters": {**OLD["parameters"], "r2": 0.75 * low}}
    sensor = sensor_of(effects=[extreme])
    model = model_of(sensor, lens_shading=[0.75 * low, *[0.0] * 6])
    assert np.isfinite(predict(model, frames[1]).mean).all()
    found, text = profile_of(model, frames)
    assert text["effects"][0]["parameters"]["r2"] == low
    assert predict(Model(found), frames[1]).mean == pytest.approx(
        predict(model, frames[1]).mean, abs=1e-6
    )


@pytest.mark.parametrize("name", ["row_noise"])
def test_what_was_fitted_whole_takes_the_place_of_the_old(frames, name):
    sensor = sensor_of(effects=[{"name": name, "parameters": {"sigma": 0.003}}])
    model = model_of(sensor, **{name: [0.005]})
    _, text = profile_of(model, frames)
    (effect,) = text["effects"]
    assert effect["parameters"]["sigma"] == pytest.approx(0.005)


@pytest.mark.parametrize(
    ("name", "key"), [("shot_noise", "beta1"), ("read_noise", "beta2")]
)
def test_noise_changes_the_table(frames, name, key):
    model = model_of(SENSOR, **{name: [0.3]})
    found, _ = profile_of(model, frames)
    old, new = SENSOR.noise_at(100), found.noise_at(100)
    assert np.array(new[key]) == pytest.approx(np.array(old[key]) * np.exp(0.3))
    (frame,) = frames_of(found, [frames[1].capture])
    expected = predict(model, frames[1]).variance
    assert predict(Model(found), frame).variance == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "values"),
    [("poisson_shot_noise", [1.0]), ("heavy_tailed_noise", [0.02, 12.0])],
)
def test_noise_that_is_drawn_otherwise_is_diagnosed_so_again(frames, name, values):
    found, _ = profile_of(model_of(SENSOR, **{name: values}), frames)
    assert name in found.noise_effects
    (frame,) = frames_of(found, [capture_of("dark", 1)])
    assert frame.noise.drawn[name] == pytest.approx(values)
    assert frame.noise.beta2 == pytest.approx(frames[0].noise.beta2)


def test_rows_are_diagnosed_so_again(frames):
    read_noise = np.sqrt(frames[0].beta2.mean())
    model = model_of(SENSOR, row_noise=[0.4 * read_noise])  # registry's unit
    found, _ = profile_of(model, frames)
    (frame,) = frames_of(found, [capture_of("dark", 1)])
    assert frame.noise.drawn["row_noise"] == pytest.approx([0.4])


def test_estimated_noise_is_written_where_there_was_none(frames):
    sensor = bare(SENSOR)
    raws = drawn(frames, Model(SENSOR), 3)
    captures = []
    for frame in raws:
        dn = np.round(frame.signal[0] * frame.range + 256).astype(np.uint16)
        captures.append(replace(frame.capture, raw=lambda dn=dn: dn))
    made = frames_of(sensor, captures)
    found, _ = profile_of(Model(sensor), made)
    assert found.noise_at(100)["beta1"][0] == pytest.approx(made[0].noise.beta1[0])
