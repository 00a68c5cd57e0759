# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The residual test of pixels that stand out in two groups of frames."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from cg2raw.diagnose.assessment.residual_tests import residual_tests
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import captures_of, drawn, frames_of, model_of, on, sensor_of

SENSOR = sensor_of()
NAME = "outliers: the same pixels in other frames"
ALARM = 1e-3 / 36


@pytest.fixture(scope="module")
def groups():
    """Return frames of two groups; a list each."""
    return [
        frames_of(SENSOR, captures_of(("dark", "dark", "flat", "scene"), group))
        for group in ("select", "report")
    ]


def outlying(seed, share=0.002):
    """Return what adds 6 standard deviations of either sign at a share of pixels, which
    are the same in all frames."""

    def extra(frame, rng):
        chosen = np.random.default_rng(seed).random(frame.signal.shape) < share
        spread = np.sqrt(predict(Model(SENSOR), frame).variance)
        return 6 * spread * chosen * rng.choice([-1, 1], chosen.shape)

    return extra


def drawn_groups(groups, seed, *extra):
    return [
        drawn(frames, Model(SENSOR), 100 * seed + n, more)
        for n, (frames, more) in enumerate(zip(groups, extra, strict=True))
    ]


def found(frames, others, model=None):
    tests = residual_tests(model or Model(SENSOR), on(frames), on(others))
    return next((test for test in tests if test.name == NAME), None)


def test_it_rings_for_pixels_that_stand_out_again(groups):
    others, frames = drawn_groups(groups, 1, outlying(1), outlying(1))
    ringing = found(frames, others)
    assert ringing.p_value < ALARM and ringing.statistic > 10
    assert ringing.nats_per_pixel > 0
    assert ringing.where == "pixels stand out that stood out in other frames"


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_outliers_elsewhere_are_silent(groups, seed):
    others, frames = drawn_groups(groups, seed, outlying(seed), outlying(seed + 50))
    assert found(frames, others).p_value > 1e-3


def test_outliers_of_one_group_alone_are_silent(groups):
    others, frames = drawn_groups(groups, 5, 0.0, outlying(5))
    assert found(frames, others).p_value > 1e-3
    others, frames = drawn_groups(groups, 6, outlying(6), 0.0)
    assert found(frames, others).p_value > 1e-3


def test_p_values_of_heavy_tails_are_uniform(groups):
    """They stand out at other places in every frame, and meet by chance alone."""

    def tails(frame, rng):
        return np.sqrt(frame.beta2) * rng.standard_t(4, frame.signal.shape)

    found_ones = [
        found(*drawn_groups(groups, seed, tails, tails)[::-1]).p_value
        for seed in range(30, 50)
    ]
    assert kstest(found_ones, "uniform").pvalue > 0.01


def test_noise_alone_is_silent(groups):
    for seed in range(10, 22):
        test = found(*drawn_groups(groups, seed, 0.0, 0.0))
        assert 1e-3 < test.p_value <= 1
        assert abs(test.statistic) < 4


def test_without_other_frames_nothing_is_asked(groups):
    others, frames = drawn_groups(groups, 8, outlying(8), outlying(8))
    assert found(frames, ()) is None
    calm = model_of(SENSOR, read_noise=[3.0], shot_noise=[1.5])  # nothing stands out
    assert found(frames, drawn_groups(groups, 9, 0.0, 0.0)[0], calm) is None


@pytest.mark.parametrize("why", ["keep", "at_white", "at_zero"])
def test_pixels_that_do_not_count_are_not_suspected(groups, why):
    others, frames = drawn_groups(groups, 23, outlying(24), outlying(24))
    pattern = np.random.default_rng(24).random(others[0].signal.shape) < 0.002

    def spoilt(frame):
        flags = getattr(frame, why)
        return replace(
            frame, **{why: flags & ~pattern if why == "keep" else flags | pattern}
        )

    silent = found(frames, [spoilt(frame) for frame in others])
    assert silent is None or silent.p_value > 1e-3
