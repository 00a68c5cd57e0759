# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random telegraph noise: few pixels of the sensor's own, states of each frame's."""

import numpy as np
import pytest
from scipy import stats

import cg2raw
from oracles import cameras

SHAPE = (300, 400)
RUN = {"illuminant": "D50", "convention": "sensor"}


def sensor_of(fraction=0.01, amplitude=0.02, **fields):
    values = {"fraction": fraction, "amplitude": amplitude}
    setting = {"name": "random_telegraph_noise", "parameters": values}
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=[setting], **fields))


def drawn(sensor, **run):
    """Return what is drawn of a grey of 0.4 without other noise, less the grey."""
    grey = np.full((*SHAPE, 3), 0.4, np.float32)
    seen = np.asarray(sensor.signal(grey, **RUN, camera_input=True, **run), float)
    return seen - np.float32(0.4)


def test_pixels_and_steps_are_the_sensors_and_states_the_frames():
    frames = [drawn(sensor_of(), seed=1, frame=n) for n in range(40)]
    steps = 2 * np.abs(frames[0])
    assert all((2 * np.abs(frame) == steps).all() for frame in frames)
    assert (2 * np.abs(drawn(sensor_of(), seed=9)) == steps).all(), "whatever the seed"
    up = np.array([frame > 0 for frame in frames])[:, steps > 0]
    # 1,200 pixels in 40 frames: half up, as often after up as after down; the steps of
    # float32 around 0.4 leave 3e-8.
    assert up.mean() == pytest.approx(0.5, abs=5 / 2 / np.sqrt(up.size))
    again = (up[1:] == up[:-1]).mean()
    assert again == pytest.approx(0.5, abs=5 / 2 / np.sqrt(up.size))


def test_steps_are_exponential_and_as_many_as_the_fraction():
    steps = 2 * np.abs(drawn(sensor_of()))
    steps = steps[steps > 0]
    expected = 0.01 * SHAPE[0] * SHAPE[1]
    assert steps.size == pytest.approx(expected, abs=5 * np.sqrt(expected))
    assert stats.kstest(steps / 0.02, "expon").pvalue > 1e-4


def test_another_sensor_has_other_pixels():
    one, other = (drawn(sensor_of(id=name)) != 0 for name in ("one", "other"))
    assert (one & other).sum() < 0.1 * one.sum()


def test_more_of_them_are_those_and_others():
    few, more = (2 * np.abs(drawn(sensor_of(fraction=f))) for f in (0.01, 0.02))
    assert (more[few > 0] > few[few > 0]).all()
    assert (more > 0).sum() > 1.8 * (few > 0).sum()


def test_the_predicted_variance_is_that_of_all_pixels():
    """Of 12,000 steps, whose mean square is known to 2 %; the mean stays."""
    sensor = sensor_of(fraction=0.1)
    grey = np.full((*SHAPE, 3), 0.4, np.float32)
    mean, variance = sensor.predict(grey, **RUN, camera_input=True)
    assert (np.asarray(mean) == np.float32(0.4)).all()
    assert np.asarray(variance) == pytest.approx(0.1 * 0.02**2 / 2, rel=1e-5)
    assert np.mean(drawn(sensor) ** 2) == pytest.approx(0.1 * 0.02**2 / 2, rel=0.1)
