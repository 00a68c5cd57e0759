# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Flicker: planted waves in differences of rows, and what is none."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import KINDS, Capture
from cg2raw.diagnose.scenes import flicker
from cg2raw.diagnose.scenes.flicker import (
    AT_ONCE,
    Waves,
    chart_series,
    is_shown,
    measured,
    validation_gain,
)

ROWS, KNOWN, LEAST = 120, 4e5, 8.0  # KNOWN : 1 / variance of a row's light, relative


def waves(seed, amplitude=0.0, period=30.0, differences=4, more=0.0, slope=0.0):
    """Differences of frames, each with a wave of chance phase; rows have noise of their
    own of @more times the variance, and a gradient."""
    rng = np.random.default_rng(seed)
    phases = rng.uniform(0, 2 * np.pi, (2, differences, 1))
    turns = 2 * np.pi * np.arange(ROWS) / period
    first, second = amplitude * np.cos(turns + phases)
    light = (first - second) / np.sqrt(2)
    light += slope * rng.standard_normal((differences, 1)) * np.linspace(-1, 1, ROWS)
    light += rng.standard_normal(light.shape) * np.sqrt((1 + more) / KNOWN)
    information = KNOWN * rng.uniform(0.5, 1.5, light.shape)
    return Waves(information * light, information)


@pytest.mark.parametrize(("amplitude", "period"), [(0.001, 30.0), (0.02, 77.3)])
def test_a_planted_wave(amplitude, period):
    """Its period is exact; its amplitude is known as well as phases are even."""
    away = []
    for seed in range(12):
        first, second = (waves((seed, k), amplitude, period) for k in range(2))
        assert validation_gain(first, second) > LEAST
        whole = waves((seed, 2), amplitude, period, differences=8)
        values, errors = measured(whole)
        away.append((values - (amplitude, period)) / errors)
        assert errors[0] == pytest.approx(amplitude / np.sqrt(32), rel=0.4)
    assert np.abs(np.mean(away, axis=0)).max() < 0.8
    assert np.std(away, axis=0).max() < 1.8


@pytest.mark.parametrize("more", [{}, {"more": 3.0}, {"slope": 0.02}])
def test_noise_rows_and_gradients_are_none(more):
    gains = [
        validation_gain(waves((seed, 3), **more), waves((seed, 4), **more))
        for seed in range(16)
    ]
    assert max(gains) < LEAST


def test_waves_are_alike_one_by_one_and_many_at_once():
    every = waves(1)
    many = np.linspace(0.02, 0.3, 3 * AT_ONCE)
    found = every.at(many)
    for n in (0, AT_ONCE, 2 * AT_ONCE + 1, len(many) - 1):
        one = every.at(many[n : n + 1])
        for whole, part in zip(found, one, strict=True):
            np.testing.assert_allclose(whole[:, n], part[:, 0], rtol=1e-9, atol=1e-6)


def test_waves_of_two_periods_are_none():
    gains = [
        validation_gain(waves((n, 5), 0.003, 20.0), waves((n, 6), 0.003, 33.0))
        for n in range(8)
    ]
    assert max(gains) < LEAST


@pytest.mark.parametrize("count", [2, 4])
def test_the_smallest_waves_are_seen_in_95_of_100_sets(count):
    smallest = waves(0, differences=count).smallest(LEAST)

    def share(of_smallest):
        sets = [
            [waves((n, k), of_smallest * smallest, differences=count) for k in (7, 8)]
            for n in range(40)
        ]
        return np.mean([validation_gain(*one) > LEAST for one in sets])

    assert share(1) >= 0.85
    assert share(0.4) <= 0.5


def test_no_waves_are_seen_for_sure_in_one_difference():
    """Its two phases may be one."""
    assert waves(0, differences=1).smallest(LEAST) == np.inf


@pytest.mark.parametrize("own", [0.0, 0.04])
def test_offsets_of_rows_are_integrated_out(own, monkeypatch):
    """By the inverse of the covariance of a row's samples, whose offset is one."""
    monkeypatch.setattr(flicker, "offset_variances", lambda _: {"row_noise": own})
    rng = np.random.default_rng(10)
    shape, variance = (1, 5, 7), rng.uniform(0.5, 2.0, (1, 5, 7))
    light, signals = rng.uniform(1, 9, shape), rng.uniform(1, 9, (2, *shape))
    tiles = SimpleNamespace(
        shape=shape[1:], rows_and_columns=lambda: (np.arange(5)[None, :, None], None)
    )
    frame = SimpleNamespace(tiles=tiles, capture=SimpleNamespace(shows=KINDS["flat"]))
    frames = [SimpleNamespace(signal=one) for one in signals]
    view = SimpleNamespace(n=2, frames=frames, frame=frame, is_table=False)
    point = SimpleNamespace(
        view=view,
        frame=frame,
        root=np.ones(shape),
        base=light,
        frame_variance=variance,
    )
    found = flicker.row_waves([point])
    away = (signals[0] - signals[1])[0] / np.sqrt(2)
    for row in range(5):
        covariance = np.diag(variance[0, row]) + own
        whitened = np.linalg.solve(covariance, light[0, row])
        assert found.information[0, row] == pytest.approx(whitened @ light[0, row])
        assert abs(found.score[0, row]) == pytest.approx(abs(whitened @ away[row]))
    tiles.shape = (3, 7)  # too few for a wave
    tiles.rows_and_columns = lambda: (np.array([0, 1, 2, 2, 2])[None, :, None], None)
    assert flicker.row_waves([point]) is None


def test_the_chart_shows_the_wave():
    shown = chart_series(waves(9, 0.01, 40.0), np.array([0.01, 40.0]))
    assert np.abs(shown.after).max() > 0.5  # %
    assert not shown.before.any()
    assert (shown.measured - shown.after).std() < 0.25
    assert list(shown.x[:2]) == [0, 1]


def test_the_chart_is_of_the_difference_that_shows_most():
    wave = np.cos(2 * np.pi * np.arange(ROWS) / 30.0)
    information = np.full((2, ROWS), KNOWN)
    light = np.stack([0.002 * wave, -0.02 * wave])
    shown = chart_series(Waves(information * light, information), np.array([0.02, 30]))
    assert np.abs(shown.measured).max() == pytest.approx(2.0, rel=0.1)  # %


@pytest.mark.parametrize(
    ("kinds", "scene", "shown"),
    [
        (["flat", "flat"], True, True),
        (["flat"], True, False),
        (["dark", "dark"], True, False),
        (["scene", "scene"], True, True),
        (["flat", "flat"], None, False),
    ],
)
def test_lit_repeats_of_both_splits_show_it(kinds, scene, shown):
    captures = [
        Capture(
            name=kind,
            kind=kind,
            shape=(4, 4),
            group=group,
            set=group,
            illuminant="D65",
            iso=100.0,
            exposure_time=0.1,
            raw=None,
            scene=scene,
        )
        for group in ("fit", "select")
        for kind in kinds
    ]
    assert is_shown(captures) == shown
    assert not is_shown(captures[: len(kinds)])
