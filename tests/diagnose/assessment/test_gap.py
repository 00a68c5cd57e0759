# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The gap between simulation and measurement is what was planted."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.assessment.gap import Sums, gap_of, systematic
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    capture_of,
    cut_at_zero,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

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


@pytest.mark.parametrize("black", [-1.0, 0.0, 2.0])
def test_chi_square_of_darks_that_are_cut_at_zero_is_one(black):
    """The ADC has 2 DN per read noise, and ends at some DN below no light."""
    sensor = sensor_of(white_level=3600, black_level=[0.0] * 4)
    captures = [capture_of("dark", n, group="report") for n in range(12)]
    shown = cut_at_zero(drawn(frames_of(sensor, captures), Model(sensor), 8), black)
    sums = sums_of(Model(sensor), shown)
    assert sums.residuals == sum(frame.keep.sum() for frame in shown)
    assert 0.1 < 1 - sums.pixels / sums.residuals < 0.8
    assert sums.chi2 == pytest.approx(1, abs=4 * np.sqrt(2 / sums.residuals))


def test_chi_square_of_darks_with_cut_row_noise_is_one():
    """Offsets are drawn, or the likeliest would take one residual of 88."""
    sensor = sensor_of(black_level=[0.0] * 4)
    captures = [capture_of("dark", n, group="report") for n in range(12)]

    def rows(frame, rng):
        sigma = 0.5 * np.sqrt(frame.beta2.mean())
        return sigma * rng.standard_normal((1, frame.tiles.size[0], 1))

    shown = cut_at_zero(drawn(frames_of(sensor, captures), Model(sensor), 9, rows))
    sums = sums_of(model_of(sensor, row_noise=[0.5]), shown)
    assert sums.chi2 == pytest.approx(1, abs=3 * np.sqrt(2 / sums.residuals))
    assert sums_of(Model(sensor), shown).chi2 > 1.1


def with_truth(frames, model, dtype=np.float32):
    result = []
    for frame in frames:
        density = log_density(model, frame)[0][0].astype(dtype)
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
    assert both.chi2 == pytest.approx(one.chi2) and both.residuals == one.residuals
    assert both.true_loss == pytest.approx(one.true_loss)
    unknown = sums_of(Model(SENSOR), drawn(frames, Model(SENSOR), 7)[:1])
    assert unknown.true_loss is None and (unknown + first).true_loss is None


@pytest.mark.parametrize("known", [True, False])
def test_intervals_hold_the_gap(known):
    """Of an exposure that the model lacks; what other draws of the noise say."""
    gaps = []
    for seed in range(12):
        frames = frames_of(SENSOR, [capture_of(n, 1) for n in ("dark", "flat")])
        true = model_of(SENSOR, **TRUE)
        frames = drawn(frames, true, seed)
        if known:
            frames = with_truth(frames, true, float)
        sums = sums_of(Model(SENSOR), frames), sums_of(true, frames)
        gaps.append(gap_of(*sums, (None, None), []))
    truth = np.mean([gap.before for gap in gaps])
    inside = [g.interval_before[0] < truth < g.interval_before[1] for g in gaps]
    assert sum(inside) >= 9
    widths = [g.interval_before[1] - g.interval_before[0] for g in gaps]
    spread = np.std([gap.before for gap in gaps])
    assert 3 * spread < np.mean(widths) < 10 * spread
    assert all(g.interval_after[0] <= 0 <= g.interval_after[1] for g in gaps[:6])
