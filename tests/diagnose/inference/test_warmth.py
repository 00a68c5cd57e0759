# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hot pixels are thermometers, and only where a temperature leaves something open."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.frames.frame import DOUBLING, warmth_of
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.warmth import reading_error, warmed
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    BY_NAME,
    ONE,
    READ,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    model_of,
)
from diagnose.planted import sensor_of as made

SENSOR = made()
TILE = (1, *SHAPE)
FACTORS = (1.0, 1.04, 0.97, 1.01, 0.99, 1.03)  # of the charge of six darks


def darks(rates):
    captures = [
        capture_of("dark", n, name=f"dark{n}", exposure_time=10.0, group=group)
        for n, group in enumerate(("fit", "fit", "fit", "select", "select", "report"))
    ]
    frames = frames_of(SENSOR, captures)
    factor = {f.capture.name: by for f, by in zip(frames, FACTORS, strict=True)}

    def extra(frame, _):
        return frame.seconds * factor[frame.capture.name] * rates

    return drawn(frames, Model(SENSOR), 7, extra)


def hot_model(rates):
    model = model_of(SENSOR, hot_pixels=[0.02])
    term = replace(model.terms[0], sensor_map=SensorMap(rates, np.full(TILE, 1e-12)))
    return model.with_term(term)


def test_each_dark_is_as_warm_as_its_hot_pixels():
    rng = np.random.default_rng(3)
    rates = np.where(rng.random(TILE) < 0.02, 40 * READ * rng.random(TILE), 0)
    splits = warmed(hot_model(rates), Splits(darks(rates), ONE), 0.05)
    found = np.array([frame.warmth for frame in splits.frames])
    truth = np.array(FACTORS) / np.exp(np.log(FACTORS[:3]).mean())
    assert found == pytest.approx(truth, abs=0.004)


def test_without_hot_pixels_or_an_open_reading_all_stays():
    none = np.zeros(TILE)
    splits = Splits(darks(none), ONE)
    assert {f.warmth for f in warmed(hot_model(none), splits, 0.05).frames} == {1.0}
    assert warmed(hot_model(none), splits, 0.0) is splits


def test_what_a_reading_leaves_open():
    """Readings that differ by 0.4 C are rounded to it: uniform within."""
    frame = darks(np.zeros(TILE))[0]
    warm = [replace(frame, warmth=2 ** (t / DOUBLING)) for t in (0.0, 0.4, 1.2)]
    expected = np.log(2) * 0.4 / DOUBLING / np.sqrt(12)
    assert reading_error(warm, False) == pytest.approx(expected, rel=1e-6)
    assert reading_error([frame], False) == 0
    assert 0.01 < reading_error([frame], True) < 0.2


def test_charge_doubles_every_few_degrees():
    capture = capture_of("dark", 1, temperature=-4.0)
    assert warmth_of(capture, -4.0 - DOUBLING) == pytest.approx(2)
    assert warmth_of(capture, None) == warmth_of(capture_of("dark", 1), 3.0) == 1
    assert BY_NAME["hot_pixels"].is_charge
