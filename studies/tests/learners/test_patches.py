# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The denoiser by least squares: its patches, and that it denoises."""

from dataclasses import replace

import numpy as np
import pytest

from studies.learners import patches as learner
from studies.learners.lesson import Lesson
from studies.protocol import PROTOCOL

SD = 0.03
RULES = replace(PROTOCOL.denoising, features=100, samples={"quick": 8000})


def noisy(planes, rng):
    """Planes with noise of one standard deviation."""
    noise = SD * rng.standard_normal(planes.shape)
    return np.asarray(planes + noise, np.float32)


def smooth(count, seed):
    """Planes (count, 4, 24, 32) without detail."""
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0.2, 0.8, 32) * rng.uniform(0.5, 1.0, (count, 4, 1, 1))
    return np.broadcast_to(ramp, (count, 4, 24, 32)).astype(np.float32)


def lesson(seed=0):
    return Lesson(smooth(30, 1), noisy, 1.0, 6, seed)


@pytest.mark.parametrize("reach", [1, 2, 3])
def test_patches_are_what_surrounds_a_site(reach):
    planes = np.random.default_rng(2).random((2, 4, 9, 8), dtype=np.float32)
    windows = learner.windows_of(planes, reach)
    side = 2 * reach + 1
    inner = planes[:, :, reach:-reach, reach:-reach]
    assert np.array_equal(windows[..., reach, reach], inner)
    one = learner.flat(windows[1, :, 0, 1])
    assert np.array_equal(one, planes[1, :, :side, 1 : 1 + side].reshape(1, -1))


def test_sites_are_drawn_from_all_frames_once():
    """Planes that count their sites: a correction of 1 says that goal and site meet."""
    clean = np.arange(3 * 4 * 7 * 8, dtype=np.float32).reshape(3, 4, 7, 8)
    rules, rng = replace(RULES, reach=1), np.random.default_rng(1)
    inputs, corrections = learner.sampled(clean - 1.0, clean, rules, 10**6, rng)
    assert np.array_equal(corrections, np.ones((3 * 5 * 6, 4)))
    assert len(np.unique(inputs, axis=0)) == 3 * 5 * 6
    few = learner.sampled(clean - 1.0, clean, rules, 7, rng)
    assert few[0].shape == (7, 36)


def test_each_feature_looks_at_a_neighbourhood_of_its_own():
    """The share of a feature's squared weights on the middle site: 1/25 without focus,
    all of it with the narrowest."""
    values = np.random.default_rng(1).random((50, 100), dtype=np.float32)

    def middle(focus):
        rules = replace(RULES, reach=2, features=500, focus=focus)
        weights = learner.local_features(values, rules, 0).weights
        squares = (weights**2).reshape(4, 25, 500).sum(axis=0)
        return squares[12] / squares.sum(axis=0)

    assert middle((1e3, 1e3)).mean() == pytest.approx(1 / 25, rel=0.1)
    assert middle((0.1, 0.1)).min() == pytest.approx(1.0)
    wide, narrow = np.quantile(middle((0.5, 3.0)), (0.05, 0.95))
    assert wide < 0.06 and narrow > 0.8


def test_it_denoises_what_is_smooth():
    clean = smooth(4, 9)
    dirty = noisy(clean, np.random.default_rng(3))
    restored = learner.patch_learner(RULES, "quick")(lesson())(dirty)
    assert restored.shape == clean.shape
    assert ((restored - clean) ** 2).mean() < 0.25 * SD**2


def test_a_seed_decides_it():
    dirty = noisy(smooth(1, 9), np.random.default_rng(3))
    learn = learner.patch_learner(RULES, "quick")
    one, again, other = (learn(lesson(seed))(dirty) for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)
