# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is handed to another process: pickles and copies, by value."""

import copy
import pickle

import numpy as np
import pytest

import cg2raw
from cg2raw import _core

WAYS = {
    **{
        f"pickle {protocol}": lambda thing, protocol=protocol: pickle.loads(
            pickle.dumps(thing, protocol)
        )
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1)
    },
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}
SCENE = np.random.default_rng(1).uniform(0, 1.2, (12, 16, 3)).astype(np.float32)


@pytest.fixture(scope="module")
def sensor(repository):
    """Return a sensor with spectra, and a lamp that has a matrix of its own."""
    path = repository / "plugins/profiles/nikon-d850.json"
    return cg2raw.Sensor(path)


@pytest.fixture(params=WAYS)
def way(request):
    return WAYS[request.param]


def values(light):
    return [light.spec, light.sensor, *light.neutral, *light.xy, light.cct, light.duv]


@pytest.mark.parametrize("word", ["D65", "sample:3", "FL2", "neutral:0.55:0.45"])
def test_a_light_stays_the_same_light(sensor, word, way):
    light = sensor.illuminant(word)
    again = way(light)
    assert values(again) == values(light)
    assert again == light and hash(again) == hash(light) and not again != light
    assert light != sensor.illuminant("A") and light != word
    assert again == sensor.illuminant(word)
    run = {"iso": 100, "convention": "spectral" if word == "FL2" else "dng"}
    frames = [sensor.simulate(SCENE, illuminant=one, **run) for one in (light, again)]
    np.testing.assert_array_equal(*frames)


RUNS = (
    {"illuminant": "sample:3", "iso": 100, "noise": "gaussian", "seed": 5, "frame": 7},
    {"illuminant": "FL2", "convention": "spectral", "digital_gain": 0.8},
    {"illuminant": "as-shot", "as_shot": [0.5, 1.0, 0.6], "highlights": False},
    {"illuminant": "A", "camera_input": True, "effects": False, "exposure_time": 0.01},
)


@pytest.mark.parametrize("run", RUNS, ids=lambda run: run["illuminant"])
def test_a_frame_keeps_its_simulation(sensor, run, way, tmp_path):
    frame = sensor.simulate(SCENE, **run)
    again = way(frame)
    assert type(again) is cg2raw.RawFrame and again.dtype == frame.dtype
    np.testing.assert_array_equal(again, frame)
    np.testing.assert_array_equal(again.simulation.raw(SCENE), frame)
    for name, one in (("a.dng", frame), ("b.dng", again)):
        cg2raw.write_dng(tmp_path / name, one)
    assert (tmp_path / "b.dng").read_bytes() == (tmp_path / "a.dng").read_bytes()


def test_a_frame_without_a_simulation_is_pickled_too(sensor, way):
    frame = sensor.simulate(SCENE, illuminant="A")[:6]
    again = way(frame)
    assert again.simulation is None and (again == frame).all()


def test_a_profile_is_its_json(sensor, way):
    assert way(sensor.profile).to_json() == sensor.to_json()
    assert way(sensor).to_json() == sensor.to_json()


def test_what_cannot_be_handed_on_says_what_can(sensor, way):
    for thing in (sensor.transform("A"), _core.Shot(), _core.Rng(1, "a")):
        words = f"{type(thing).__name__} cannot be copied or pickled: hand on what it"
        with pytest.raises(TypeError, match=words):
            way(thing)


def test_a_pickle_of_something_else_is_an_error(sensor):
    data = pickle.dumps(sensor.illuminant("D65"), 0)
    for old, new in ((b"F1.0", b"Vx"), (b"Illuminant", b"Run")):
        assert old in data
        with pytest.raises((TypeError, ValueError, pickle.UnpicklingError)):
            pickle.loads(data.replace(old, new))
