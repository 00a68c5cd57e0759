# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Charts of darks show what was planted, with it and without."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.darks_and_flats import TEST
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.verdict.charts import _drift, _levels, _parts, _tails
from cg2raw.model.fit import fit
from cg2raw.normal import CI95
from diagnose.planted import sensor_of
from model.shapes.planted import BLACK, NOISE, SHAPE, darks, normal, statistics_of
from model.shapes.test_noisy_pixels import tails

SENSOR = sensor_of()
NONE = np.zeros(SHAPE)
DRIFT = 5.0  # DN


def finding_of(name, **values):
    """Return a finding by its numbers."""
    estimates = {key: Estimate(one, "1", (one, one)) for key, one in values.items()}
    return SimpleNamespace(name=name, parameters=estimates)


def drifting(rng, shape):
    """Return noise, and a level of each frame's own."""
    return normal(rng, shape) + DRIFT * rng.standard_normal()


def fit_of(noise, split=TEST):
    """Return the fit of four darks of no time."""
    return fit(statistics_of(darks(1, split, NONE, times=(0.0,), noise=noise)))


def test_tails_are_shares_of_differences_with_and_without_them():
    """A draw in 50 of nine times the variance, as planted: shares of 69,120 differences
    of a percent are known to 4 %."""
    statistics = statistics_of(
        darks(1, TEST, NONE, times=(0.0,), frames=12, noise=tails)
    )
    finding = finding_of("heavy_tailed_noise", fraction=0.02, variance_ratio=9.0)
    found = SimpleNamespace(statistics=statistics)
    chart = _tails(finding.name, found, finding)
    (one,) = chart.series
    assert one.measured.sum() == pytest.approx(100, abs=0.01)
    often = one.measured > 0.3
    assert one.after[often] == pytest.approx(one.measured[often], rel=0.15)
    far = one.x > 4.0  # standard deviations
    assert np.nan_to_num(one.before[far]).max() < 0.01  # far below all that is measured
    assert one.measured[far].sum() > 0.1


def test_a_drift_is_shown_frame_by_frame_with_bands_of_noise_and_of_both():
    """Darks in the order of the captures; each level less the mean of its repeats."""
    first, second = fit_of(drifting), fit_of(drifting, "training")
    levels = [one.likelihood.planes for one in (second, first)]
    names = [f"{split} 0.0 {n}" for split in ("training", TEST) for n in range(4)]
    order = [names[n] for n in (0, 4, 1, 5, 2, 6, 3, 7)]
    found = SimpleNamespace(
        captures=SimpleNamespace(
            captures=[SimpleNamespace(name=name) for name in order], sensor=SENSOR
        )
    )
    finding = finding_of("black_level_drift", sigma=DRIFT / SENSOR.signal_range)
    (one,) = _drift(finding, found, (first, second)).series
    means = [np.mean([p.plane.levels[0] for p in each], axis=0) for each in levels]
    away = np.transpose([each - each.mean() for each in means]).ravel()
    assert list(one.x) == [*range(1, 9)] and one.measured == pytest.approx(away)
    noise = CI95 * NOISE / np.sqrt(np.prod(SHAPE))  # of the level of a frame
    assert one.before == pytest.approx(noise, rel=0.2)
    assert one.after == pytest.approx(CI95 * DRIFT, rel=0.01)


def test_levels_of_one_exposure_time_are_bars_above_the_profiles_black():
    test = fit_of(normal)
    profile = test.theta.copy()
    profile[test.parameters.each("black_level")] = BLACK - 7.0
    chart = _levels("black_level", SimpleNamespace(profile=profile), test)
    (one,) = chart.series
    assert chart.form == "bars" and len(chart.names) == 1
    assert one.measured == pytest.approx(7.0, abs=0.1)
    assert one.before == 0 and one.after == pytest.approx(7.0, abs=0.1)


def test_noise_of_frames_that_nothing_repeats_is_in_mean_frames():
    groups = [
        (replace(info, frames=info.frames[:1]), frames[:1])
        for info, frames in darks(1, TEST, NONE)
    ]
    test = fit(statistics_of(groups))
    found = SimpleNamespace(profile=np.where(test.parameters.are(["read_noise"]), 1, 0))
    chart = _parts("read_noise", found, test)
    assert chart.title == "Mean darks: single pixels"
