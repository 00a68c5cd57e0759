# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""effect.h: the laws that every registered effect obeys."""

import cg2raw
import numpy as np
import pytest

from oracles import cameras

STAGES = ("optics", "pixel", "response", "noise", "readout", "conversion", "output")
EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}
# Parameters that shape a noise whose strength is another parameter.
SHAPES = ("tukey_lambda",)
PHYSICAL = ("photon_statistics", "heavy_tailed_noise", "row_noise")


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


def tenth(parameter):
    """A tenth of the way from null to a bound."""
    p = parameter
    bound = p["max"] if p["max"] != p["null"] else p["min"]
    return p["null"] + 0.1 * (bound - p["null"])


def strong(name):
    """Every parameter at a tenth."""
    return {p["name"]: tenth(p) for p in EFFECTS[name]["parameters"]}


def strengths(name):
    """Every parameter at a tenth, and each one that acts alone, others null."""
    yield strong(name)
    for p in EFFECTS[name]["parameters"]:
        if p["name"] not in SHAPES:
            yield {p["name"]: tenth(p)}


def signal(sensor, **run):
    return np.asarray(sensor.signal(scene(), illuminant="D50", **run), float)


def test_the_registry_is_complete_and_in_the_order_of_the_stages():
    named = {"lens_shading", "shot_noise", "read_noise", "quantisation", *PHYSICAL}
    assert named <= set(EFFECTS)
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
    """Alone, or with the others if it is a shape."""
    all_on = strong(name)
    for p in EFFECTS[name]["parameters"]:
        shape = p["name"] in SHAPES
        others = all_on if shape else {}
        less, more = {**others, p["name"]: p["null"]}, {**others, p["name"]: tenth(p)}
        seen = [signal(sensor_with(name, **values)) for values in (less, more)]
        assert (seen[0] != seen[1]).any(), p["name"]


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
def test_what_is_temporal_changes_from_frame_to_frame(name):
    temporal = EFFECTS[name]["pattern"] == "temporal"
    for values in strengths(name):
        frames = [signal(sensor_with(name, **values), frame=f) for f in (0, 1)]
        seeds = [signal(sensor_with(name, **values), seed=s) for s in (0, 1)]
        assert (frames[0] != frames[1]).any() == temporal
        assert (seeds[0] != seeds[1]).any() >= temporal


@pytest.mark.parametrize("name", EFFECTS)
def test_threads_do_not_matter(name):
    sensor = sensor_with(name, **strong(name))
    rgb = scene(150, 601)
    raw = [
        sensor.simulate(rgb, illuminant="D50", seed=3, threads=t).tobytes()
        for t in (1, 2, 7)
    ]
    assert raw[0] == raw[1] == raw[2]


@pytest.mark.parametrize("name", EFFECTS)
def test_a_pixel_does_not_depend_on_the_image_around_it(name):
    if name == "lens_shading":
        pytest.skip("its centre is that of the image")
    sensor = sensor_with(name, **strong(name))
    rgb = scene(40, 700)
    whole, part = (
        np.asarray(sensor.signal(image, illuminant="D50", seed=4))
        for image in (rgb, rgb[:33, :421])
    )
    assert (whole[:33, :421] == part).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_drawn_mean_and_variance_are_the_predicted_ones(name):
    """Of many rows, whose draws are independent even where those of a row are not."""
    rows = 40000
    sensor = sensor_with(name, **strong(name))
    rgb, run = scene(rows, 16), {"illuminant": "D50", "seed": 6}
    mean, variance = (np.asarray(x, float) for x in sensor.expectation(rgb, **run))
    left = np.asarray(sensor.signal(rgb, **run), float) - mean
    if not variance.any():
        assert not left.any()
        return
    z = left / np.sqrt(variance)
    assert z.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(rows))
    assert z.var() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / rows))
    # The signal's own mean does not leak into the noise.
    slope = np.polyfit(mean.ravel(), left.ravel(), 1)[0]
    assert abs(slope) < 5.0 * np.sqrt(variance.mean() / mean.var() / mean.size)


def test_drawn_effects_and_gaussian_ones_add_up():
    """No variance is drawn twice, and the order within a stage does not matter."""
    rows = 40000
    names = ("photon_statistics", "heavy_tailed_noise", "row_noise", "shot_noise")
    values = {"beta1": 0.01, "beta2": 4e-4, "tukey_lambda": 0.0, "sigma": 0.02}
    effects = [
        {
            "name": name,
            "parameters": {
                p["name"]: values[p["name"].partition("_0")[0].partition("_1")[0]]
                for p in EFFECTS[name]["parameters"]
            },
        }
        for name in names
    ]
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(effects=effects))
    rgb, run = scene(rows, 16), {"illuminant": "D50", "seed": 6}
    mean, variance = (np.asarray(x, float) for x in sensor.expectation(rgb, **run))
    assert variance == pytest.approx(8e-4 + 0.02 * mean, rel=1e-5)
    z = (np.asarray(sensor.signal(rgb, **run), float) - mean) / np.sqrt(variance)
    assert z.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(rows))
    assert z.var() == pytest.approx(1.0, abs=0.01)
    slope = np.polyfit(mean.ravel(), (z**2).ravel(), 1)[0]
    assert abs(slope) < 5.0 * np.sqrt(2.0 / z.size) / mean.std()


@pytest.mark.parametrize("name", EFFECTS)
def test_what_was_clipped_stays_white(name):
    if name == "lens_shading":
        pytest.skip("it acts before the sensor clips")
    sensor = sensor_with(name, **strong(name))
    raw = sensor.simulate(scene() + 20.0, illuminant="D50", seed=3)
    assert (raw == sensor.white_level).all()
    _, variance = sensor.expectation(scene() + 20.0, illuminant="D50")
    assert EFFECTS[name]["stage"] == "conversion" or not variance.any()


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
    values |= {"tilt_x_r2": 0.07, "tilt_y_r2": -0.03}
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
    gain += square * (0.07 * u - 0.03 * v)
    assert shaded == pytest.approx(clean * gain, abs=1e-6)


def test_lens_shading_never_turns_light_negative():
    values = {"r2": -2.0, "r4": 0.0, "r6": 0.0, "tilt_x": 0.5, "tilt_y": 0.5}
    assert signal(sensor_with("lens_shading", **values)).min() == 0.0
