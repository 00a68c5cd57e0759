# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The gap between simulation and measurement is what was planted."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.planted import capture_of, drawn, frames_of, model_of, sensor_of

from cg2raw.diagnose.gap import Sums, gap_of, systematic
from cg2raw.diagnose.likelihood import log_density
from cg2raw.diagnose.prediction import Model, predict

SENSOR = sensor_of()
TRUE = {"exposure": [0.02]}


@pytest.fixture(scope="module")
def frames():
    captures = [
        capture_of("scene", 3, set="a", name=f"a{n}", group="report") for n in range(2)
    ]
    return frames_of(SENSOR, captures)


def test_the_systematic_gap_is_the_squared_error_of_the_mean(frames):
    true, base = model_of(SENSOR, **TRUE), Model(SENSOR)
    p, wrong = predict(true, frames[0]), predict(base, frames[0])
    used = frames[0].keep & (wrong.mean < 0.95)
    expected = ((p.mean - wrong.mean) ** 2 / wrong.variance)[used].mean()
    found = [systematic(base, base, drawn(frames, true, seed)) for seed in range(20)]
    error = np.std(found) / np.sqrt(20)
    assert np.mean(found) == pytest.approx(expected, abs=4 * error)
    assert expected > 20 * error


def test_it_is_nothing_for_the_true_model_whatever_the_noise(frames):
    true, base = model_of(SENSOR, **TRUE), Model(SENSOR)
    noisier = model_of(SENSOR, **TRUE, read_noise=[0.7], shot_noise=[0.5])
    found = [systematic(true, base, drawn(frames, noisier, seed)) for seed in range(20)]
    assert abs(np.mean(found)) < 4 * np.std(found) / np.sqrt(20)


def test_it_is_nothing_where_noise_reaches_zero(frames):
    """A camera without a pedestal: products of what is not clipped alone are biased."""
    found = []
    for seed in range(10):
        shown = []
        for frame in drawn(frames, Model(SENSOR), seed):
            level = np.quantile(frame.signal, 0.3)
            signal = np.maximum(frame.signal, level)
            shown.append(replace(frame, signal=signal, at_zero=signal <= level))
        found.append(systematic(Model(SENSOR), Model(SENSOR), shown))
    assert abs(np.mean(found)) < 4 * np.std(found) / np.sqrt(10)


def test_there_is_none_without_repeats(frames):
    shown = drawn(frames, Model(SENSOR), 1)
    assert systematic(Model(SENSOR), Model(SENSOR), shown[:1]) is None


def sums_of(model, frames):
    sums = Sums()
    for frame in frames:
        sums.add(model, frame)
    return sums


def with_truth(frames, model):
    result = []
    for frame in frames:
        density = log_density(model, frame)[0][0].astype(np.float32)
        capture = replace(frame.capture, log_density=lambda density=density: density)
        result.append(replace(frame, capture=capture))
    return result


def test_the_true_model_has_no_gap_and_another_has_its_divergence(frames):
    true, base = model_of(SENSOR, **TRUE), Model(SENSOR)
    shown = with_truth(drawn(frames, true, 5), true)
    gap = gap_of(sums_of(base, shown), sums_of(true, shown), (None, None), ["a"])
    assert gap.after == pytest.approx(0, abs=1e-6)
    p, wrong = predict(true, frames[0]), predict(base, frames[0])
    ratio = p.variance / wrong.variance
    square = (p.mean - wrong.mean) ** 2 / wrong.variance
    divergence = 0.5 * (ratio + square - 1 - np.log(ratio))[frames[0].keep].mean()
    assert gap.before == pytest.approx(divergence, rel=0.1)
    assert gap.chi2_after == pytest.approx(1, abs=0.05)
    assert gap.chi2_before == pytest.approx(
        (ratio + square)[frames[0].keep].mean(), 0.1
    )


def test_without_a_truth_it_is_what_the_residuals_leave(frames):
    shown = drawn(frames, model_of(SENSOR, **TRUE), 6)
    base = sums_of(Model(SENSOR), shown)
    gap = gap_of(base, base, (None, None), ["a"])
    assert gap.before == gap.after == pytest.approx(0.5 * (base.chi2 - 1))


def test_sums_add_up(frames):
    shown = with_truth(drawn(frames, Model(SENSOR), 7), Model(SENSOR))
    first, second = (sums_of(Model(SENSOR), [frame]) for frame in shown)
    both, one = first + second, sums_of(Model(SENSOR), shown)
    assert both.loss == pytest.approx(one.loss) and both.pixels == one.pixels
    assert both.true_loss == pytest.approx(one.true_loss)
    unknown = sums_of(Model(SENSOR), drawn(frames, Model(SENSOR), 7)[:1])
    assert unknown.true_loss is None and (unknown + first).true_loss is None
