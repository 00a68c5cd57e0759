# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""effect.h: the laws that every registered effect obeys."""

import cg2raw
import numpy as np
import pytest

from oracles import cameras

STAGES = ("optics", "pixel", "response", "noise", "readout", "output")
EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}


def scene(height=40, width=60):
    rng = np.random.default_rng(8)
    return rng.uniform(0.1, 0.6, (height, width, 3)).astype(np.float32)


def sensor_with(name=None, **values):
    """A sensor with one effect; parameters that are not given are null."""
    if name is None:
        return cg2raw.Sensor.from_json(cameras.profile_text())
    parameters = {p["name"]: p["null"] for p in EFFECTS[name]["parameters"]}
    parameters.update(values)
    setting = {"name": name, "parameters": parameters}
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=[setting]))


def strengths(name):
    """Every parameter once, a tenth of the way from null to a bound, others null."""
    for p in EFFECTS[name]["parameters"]:
        bound = p["max"] if p["max"] != p["null"] else p["min"]
        yield {p["name"]: p["null"] + 0.1 * (bound - p["null"])}


def signal(sensor, **run):
    return np.asarray(sensor.signal(scene(), illuminant="D50", **run), float)


def test_the_registry_is_complete_and_in_the_order_of_the_stages():
    assert {"lens_shading", "shot_noise", "read_noise"} <= set(EFFECTS)
    keys = [(STAGES.index(e["stage"]), e["name"]) for e in EFFECTS.values()]
    assert keys == sorted(keys)


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_says_what_it_is(name):
    effect = EFFECTS[name]
    assert effect["meaning"] and effect["source"] and effect["parameters"]
    for p in effect["parameters"]:
        assert p["name"] and p["unit"] and p["meaning"]
        assert p["min"] <= p["null"] <= p["max"] and p["min"] < p["max"]


@pytest.mark.parametrize("name", EFFECTS)
def test_null_parameters_are_identity(name):
    assert (signal(sensor_with(name)) == signal(sensor_with())).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_every_parameter_does_something(name):
    for values in strengths(name):
        assert (signal(sensor_with(name, **values)) != signal(sensor_with())).any(), (
            values
        )


@pytest.mark.parametrize("name", EFFECTS)
def test_effects_can_be_left_out_of_a_run(name):
    for values in strengths(name):
        seen = signal(sensor_with(name, **values), effects=False)
        assert (seen == signal(sensor_with())).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_one_key_one_frame(name):
    for values in strengths(name):
        runs = [signal(sensor_with(name, **values), seed=5, frame=2) for _ in range(2)]
        assert (runs[0] == runs[1]).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_only_noise_changes_from_frame_to_frame(name):
    temporal = EFFECTS[name]["stage"] == "noise"
    for values in strengths(name):
        frames = [signal(sensor_with(name, **values), frame=f) for f in (0, 1)]
        seeds = [signal(sensor_with(name, **values), seed=s) for s in (0, 1)]
        assert (frames[0] != frames[1]).any() == temporal
        assert (seeds[0] != seeds[1]).any() >= temporal


@pytest.mark.parametrize("name", EFFECTS)
def test_parameters_out_of_bounds_are_named(name):
    for p in EFFECTS[name]["parameters"]:
        for value in (p["min"] - 1.0, p["max"] + 1.0):
            with pytest.raises(ValueError, match=f"{name}.*{p['name']}"):
                signal(sensor_with(name, **{p["name"]: value}))


def test_unknown_parameters_are_named():
    with pytest.raises(ValueError, match="lens_shading.*r8.*r2"):
        signal(sensor_with("lens_shading", r8=0.1))


def test_an_effect_may_not_act_twice():
    noisy = sensor_with("shot_noise", beta1_00=1e-4)
    with pytest.raises(ValueError, match="shot_noise.*twice"):
        signal(noisy, iso=100)


@pytest.mark.parametrize("size", [(40, 60), (41, 61), (200, 3)])
def test_lens_shading_is_its_polynomial(size):
    values = {"r2": -0.5, "r4": 0.3, "r6": -0.1, "tilt_x": 0.05, "tilt_y": -0.02}
    rgb = scene(*size)
    clean, shaded = (
        np.asarray(s.signal(rgb, illuminant="D50"), float)
        for s in (sensor_with(), sensor_with("lens_shading", **values))
    )
    height, width = size
    half = np.hypot(width, height) / 2.0
    v = (np.arange(height)[:, None] + 0.5 - height / 2.0) / half
    u = (np.arange(width)[None, :] + 0.5 - width / 2.0) / half
    square = u**2 + v**2
    gain = 1.0 - 0.5 * square + 0.3 * square**2 - 0.1 * square**3 + 0.05 * u - 0.02 * v
    assert shaded == pytest.approx(clean * gain, abs=1e-6)


def test_lens_shading_never_turns_light_negative():
    values = {"r2": -2.0, "r4": 0.0, "r6": 0.0, "tilt_x": 0.5, "tilt_y": 0.5}
    assert signal(sensor_with("lens_shading", **values)).min() == 0.0
