# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Decays and the glow of an amplifier, planted, with their errors."""

import math

import numpy as np
import pytest

from cg2raw.calibration.measured import LinearFit, Measured
from cg2raw.calibration.structure import (
    BiasStructure,
    correlated,
    fit_decay,
    glow,
    ramp_and_edge,
)


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


def test_a_glow_is_known_as_well_as_its_errors_say():
    """By how much they differ in eight maps of noise, but for the row, which is at its
    bound; noise alone has none."""
    shape, found = (96, 128), []
    away = np.hypot.outer(np.arange(96) + 0.5, np.arange(128) - 63.5) / 80  # px
    for seed in range(8):
        noise = 0.1 * np.random.default_rng(seed).standard_normal(shape)
        one = glow(np.exp(-away / 0.3) + noise)
        found.append([one.per_second, one.column, one.extent])
        assert one.is_measured and one.certainty > 20
    assert not glow(noise).stands_out
    values, errors = (
        np.array([[getattr(one, name) for one in each] for each in found])
        for name in ("value", "standard_error")
    )
    assert values.std(axis=0) == pytest.approx(errors.mean(axis=0), rel=0.6)


@pytest.mark.parametrize("r", [0.0, 0.5])
def test_neighbours_that_correlate_widen_errors(r):
    """Of a series whose next values correlate by r, the mean's is (1 + r) / (1 - r)
    times the variance of white noise."""
    rest = np.random.default_rng(1).standard_normal(40_000)
    for n in range(1, len(rest)):
        rest[n] = r * rest[n - 1] + rest[n] * math.sqrt(1 - r**2)
    found = correlated(LinearFit(np.zeros(0), np.zeros(0), rest, 1.0))
    assert found == pytest.approx(math.sqrt((1 + r) / (1 - r)), rel=0.02)


def test_a_ramp_and_first_columns_are_found_within_their_errors():
    """Of 400 columns with noise of 0.3 DN, a few of which are far off."""
    at, away = np.arange(400), []
    plain = 5 * ((at + 0.5) / 400 - 0.5)
    for seed in range(40):
        rng = np.random.default_rng(seed)
        profile = plain + 9 * np.exp(-at / 12) + 0.3 * rng.standard_normal(400)
        profile[rng.integers(40, 400, 4)] += 20
        ramp, edge, length, fitted = ramp_and_edge(profile)
        assert (ramp.unit, edge.unit, length.unit) == ("DN", "DN", "px")
        away.append(
            [
                (one.value - truth) / one.standard_error
                for one, truth in ((ramp, 5), (edge, 9), (length, 12))
            ]
        )
    assert fitted == pytest.approx(plain + 9 * np.exp(-at / 12), abs=0.4)
    assert np.std(away, axis=0) == pytest.approx([1, 1, 1], rel=0.35)
    assert np.abs(np.mean(away, axis=0)).max() < 0.6


@pytest.mark.parametrize(
    ("columns", "height", "with_edge"),
    [(400, 0.0, True), (31, 9.0, True), (400, 9.0, False)],
)
def test_a_ramp_alone_is_a_straight_line(columns, height, with_edge):
    """Where no columns differ, where they are too few, and of rows."""
    at = np.arange(columns)
    profile = 5 * ((at + 0.5) / columns - 0.5) + height * np.exp(-at / 12)
    profile += 0.3 * np.random.default_rng(1).standard_normal(columns)
    ramp, edge, length, fitted = ramp_and_edge(profile, with_edge)
    assert edge is None and length is None
    slope, middle = np.polyfit(at, fitted, 1)
    assert fitted == pytest.approx(middle + slope * at)
    assert ramp.value == pytest.approx(slope * columns)
    if not height:
        assert ramp.value == pytest.approx(5, abs=4 * ramp.standard_error)


@pytest.mark.parametrize(("length", "is_longer"), [(20.0, False), (49.99, True)])
def test_an_edge_as_long_as_any_that_is_tried_may_be_longer(length, is_longer):
    """Of a sixth of 300 columns; of its mean over all, e-fold by e-fold."""
    one = Measured(4.0, 0.1, "DN")
    profiles = 4 * [np.zeros(300)]
    found = BiasStructure(one, one, one, Measured(length, 0.1, "px"), *profiles)
    assert found.edge_is_longer == is_longer
    mean = 4 * (1 - np.exp(-300 / length)) / (1 - np.exp(-1 / length)) / 300
    assert found.edge_mean == pytest.approx(mean)
    without = BiasStructure(one, one, None, None, *profiles)
    assert without.edge_mean == 0 and not without.edge_is_longer
