# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Residual tests of frames whose sensor has a map: its slow part is no structure."""

import numpy as np

from cg2raw.diagnose.assessment.residual_tests import residual_tests
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    READ,
    capture_of,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
GAINS = 0.02


def flats(group):
    return captures_of(["flat"] * 6, group, level=0.6)


def p_values(frames, model):
    return {
        test.name: test.p_value
        for test in residual_tests(model, on(frames), on([]))
        if "mean" in test.name and "frame mean" not in test.name
    }


def test_the_slow_part_of_a_map_is_no_structure(monkeypatch):
    """A map is high-passed: means of tiles and columns stay in the residuals."""
    both = frames_of(SENSOR, flats("fit") + flats("report"))
    pattern = GAINS * np.random.default_rng(5).standard_normal(both[0].signal.shape)

    def extra(frame, _):
        return pattern * predict(Model(SENSOR), frame).mean

    shown = drawn(both, Model(SENSOR), 6, extra)
    model = fit_patterns(model_of(SENSOR, prnu=[0.0]), on(shown[:6]))
    assert min(p_values(shown[6:], model).values()) > 1e-3
    monkeypatch.setattr(type(BY_NAME["prnu"]), "lacks_slow_part", False)
    assert min(p_values(shown[6:], model).values()) < 1e-6


def test_a_structure_beside_a_map_is_still_seen():
    both = frames_of(SENSOR, flats("fit") + flats("report"))
    pattern = GAINS * np.random.default_rng(5).standard_normal(both[0].signal.shape)

    def extra(frame, _):
        light = predict(Model(SENSOR), frame).mean
        u, _ = frame.tiles.field()
        return (pattern + 0.01 * np.sin(6 * u)) * light

    shown = drawn(both, Model(SENSOR), 6, extra)
    model = fit_patterns(model_of(SENSOR, prnu=[0.0]), on(shown[:6]))
    assert p_values(shown[6:], model)["tile mean"] < 1e-9


def test_pixels_that_are_hot_or_of_a_law_are_no_fixed_pattern():
    """Where it is even which, what one map has less, the other has more: all in all
    frames tell the rate of such a pixel, and leave no more of it than of others."""
    rng = np.random.default_rng(11)
    shape = (144, 192)
    rates = 0.5 * READ * np.exp(1.1 * rng.standard_normal((1, *shape)))
    rates += (rng.random(rates.shape) < 0.02) * rng.exponential(20 * READ, rates.shape)

    def charge(frame, rng):
        mean = frame.seconds * rates
        return mean + np.sqrt(frame.beta1 * mean) * rng.standard_normal(rates.shape)

    captures = [
        capture_of("dark", n, exposure_time=seconds, shape=shape, group=group)
        for group in ("fit", "report")
        for n, seconds in enumerate((0.0, 1.0, 4.0, 4.0))
    ]
    shown = drawn(frames_of(SENSOR, captures), Model(SENSOR), 12, charge)
    maps = {"dark_current_nonuniformity": [0.0], "hot_pixels": [0.0]}
    model = model_of(SENSOR, dark_current=[0.5 * READ], **maps)
    model = fit_patterns(model, on(shown[:4]))
    hot = model.term("hot_pixels").sensor_map.mean
    assert (hot > READ).sum() > 100
    found = residual_tests(model, on(shown[4:]), on([]))
    assert next(t.p_value for t in found if "same pixel" in t.name) > 1e-3
