# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Decays and the glow of an amplifier, planted, with their errors."""

import math

import numpy as np
import pytest

from cg2raw.calibration.measured import LinearFit
from cg2raw.calibration.structure import correlated, fit_decay, glow


def test_a_decay_is_found_within_its_errors():
    """Of its length the error is that of a step of Gauss and Newton."""
    x = np.arange(300.0)
    straight, lengths = np.column_stack([np.ones(300), x]), np.geomspace(2, 200, 20)
    away = []
    for seed in range(60):
        noise = np.random.default_rng(seed).normal(0, 0.2, 300)
        y = 2 + 0.01 * x + 3 * np.exp(-x / 17) + noise
        _, height, length, errors = fit_decay(straight, x, y, lengths)
        away.append(np.divide([height - 3, length - 17], errors[-2:]))
    assert np.abs(np.mean(away, axis=0)).max() < 0.5
    assert np.std(away, axis=0) == pytest.approx([1, 1], rel=0.3)


@pytest.mark.parametrize(("row", "column"), [(-1.0, -0.9), (0.1, 1.0)])
def test_a_planted_glow_is_found_with_its_place(row, column):
    """Within four errors, and 3 % by blocks that are a seventh of its extent wide."""
    shape, extent = (384, 512), 0.25
    half = math.hypot(*shape) / 2
    y, x = (np.arange(n) + 0.5 - n / 2 for n in shape)
    away = np.hypot.outer(y - row * shape[0] / 2, x - column * shape[1] / 2) / half
    shine = 1.5 * np.exp(-away / extent)
    noise = 0.15 * np.random.default_rng(3).standard_normal(shape)
    found = glow((2 + shine + noise).astype(np.float32))
    assert found.is_measured
    for one, truth in (
        (found.per_second, 1.5),
        (found.row, row),
        (found.column, column),
        (found.extent, extent),
    ):
        within = 4 * one.standard_error + 0.03 * abs(truth)
        assert one.value == pytest.approx(truth, abs=within)
        assert one.standard_error < 0.02
    assert found.mean == pytest.approx(shine.mean(), rel=0.05)


@pytest.mark.parametrize("r", [0.0, 0.5])
def test_neighbours_that_correlate_widen_errors(r):
    """Of a series whose next values correlate by r, the mean's is (1 + r) / (1 - r)
    times the variance of white noise."""
    rest = np.random.default_rng(1).standard_normal(40_000)
    for n in range(1, len(rest)):
        rest[n] = r * rest[n - 1] + rest[n] * math.sqrt(1 - r**2)
    found = correlated(LinearFit(np.zeros(0), np.zeros(0), rest, 1.0))
    assert found == pytest.approx(math.sqrt((1 + r) / (1 - r)), rel=0.02)
