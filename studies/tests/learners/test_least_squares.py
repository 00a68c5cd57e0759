# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Least squares on random features: what it learns, and which ridge it keeps."""

import numpy as np
import pytest

from studies.learners.least_squares import features, learn, sums

RIDGES = [1e-8, 1e-5, 1e-2, 1.0]


def drawn(count, seed, noise=0.0):
    """Inputs (count, 3), and outputs (count, 2) that are no linear function of them."""
    rng = np.random.default_rng(seed)
    values = rng.uniform(0.0, 1.0, (count, 3)).astype(np.float32)
    r, g, b = values.T
    outputs = np.column_stack([np.sqrt(r * g), np.maximum(b - 0.5 * r, 0.0)])
    outputs = outputs + rng.normal(0.0, noise, outputs.shape)
    return values, outputs.astype(np.float32)


def test_it_learns_what_is_not_linear():
    learnt = learn(drawn(6000, 1), drawn(1000, 2), 200, RIDGES, seed=0)
    values, outputs = drawn(1000, 3)
    error = learnt(values) - outputs
    linear = np.column_stack([values, np.ones(len(values))])
    plain = linear @ np.linalg.lstsq(linear, outputs, rcond=None)[0] - outputs
    assert np.sqrt((error**2).mean()) < 0.15 * np.sqrt((plain**2).mean())


def test_few_noisy_frames_get_a_stronger_ridge():
    few = learn(drawn(60, 1, 0.3), drawn(2000, 2, 0.3), 400, RIDGES, seed=0)
    many = learn(drawn(20000, 1), drawn(2000, 2), 400, RIDGES, seed=0)
    assert few.ridge > many.ridge


def test_a_seed_decides_the_features():
    values, outputs = drawn(500, 1)
    pair = (values, outputs)
    one, again, other = (
        learn(pair, pair, 50, RIDGES, seed)(values) for seed in (1, 1, 2)
    )
    assert np.array_equal(one, again)
    assert not np.allclose(one, other, atol=1e-7)


def test_sums_are_those_of_all_rows_at_once():
    values, outputs = drawn(70000, 4)
    layer = features(values, 20, 0)
    whole = layer(values).astype(np.float64)
    normal, right = sums(layer, values, outputs)
    assert normal == pytest.approx(whole.T @ whole, rel=1e-9)
    assert right == pytest.approx(whole.T @ outputs, rel=1e-9)
