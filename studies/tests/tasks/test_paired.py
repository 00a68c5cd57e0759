# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.tasks.paired: planted differences, and how often chance alone beats."""

import numpy as np
import pytest

from studies.tasks.paired import difference, share_left


def errors(seed, mean=3.0, of_seeds=0.3, of_frames=2.0, noise=1.0, shape=(10, 200)):
    rng = np.random.default_rng(seed)
    seeds, frames = rng.normal(0, of_seeds, (10, 1)), rng.normal(0, of_frames, 200)
    return mean + seeds + frames + rng.normal(0, noise, shape)


def test_what_both_have_in_common_cancels():
    common = errors(1)
    found = difference(common - 0.5, common)
    assert found.mean == pytest.approx(-0.5)
    assert found.error == pytest.approx(0.0, abs=1e-9)
    assert found.beats and not difference(common, common - 0.5).beats


def test_the_error_is_that_of_seeds_and_of_frames():
    """Each alone is drawn 10 and 200 times."""
    rng = np.random.default_rng(2)
    zero, found = np.zeros((10, 200)), []
    for _ in range(400):
        one = rng.normal(0, 0.5, (10, 1)) + rng.normal(0, 1.5, (1, 200))
        found.append(difference(one, zero))
    spread = np.std([f.mean for f in found])
    assert spread == pytest.approx(np.hypot(0.5 / 10**0.5, 1.5 / 200**0.5), rel=0.1)
    assert np.mean([f.error for f in found]) == pytest.approx(spread, rel=0.1)


def test_chance_hardly_ever_beats():
    rng = np.random.default_rng(3)
    beats = [
        difference(
            rng.normal(0, 1, (10, 1)) + rng.normal(0, 1, (10, 50)), np.zeros((10, 50))
        ).beats
        for _ in range(500)
    ]
    assert np.mean(beats) < 0.03


def test_the_share_of_a_gap():
    real = errors(4)
    assert share_left(real + 0.2, real + 1.0, real) == pytest.approx(0.2)
    assert np.isnan(share_left(real + 0.2, real, real))
