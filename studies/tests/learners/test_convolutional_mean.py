# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convolutional Mean: its size, what it learns, that a seed decides it."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners import convolutional_mean as learner  # noqa: E402
from studies.protocol import PROTOCOL  # noqa: E402
from studies.tasks.angles import degrees  # noqa: E402

RULES = replace(PROTOCOL.illuminant, batch=16)


def frames(count, seed):
    """Grey frames (count, 16, 20, 3) under drawn lights, and their neutrals."""
    rng = np.random.default_rng(seed)
    neutrals = np.column_stack(
        [rng.uniform(0.4, 0.9, count), np.ones(count), rng.uniform(0.3, 0.8, count)]
    )
    grey = rng.uniform(0.1, 0.9, (count, 16, 20, 1))
    return (grey * neutrals[:, None, None]).astype(np.float32), neutrals


def test_it_has_as_many_weights_as_published():
    weights = learner.network(0).parameters()
    assert sum(w.numel() for w in weights) == 1137


@pytest.fixture(scope="module")
def trained():
    return learner.train(*frames(160, 1), RULES, epochs=40, seed=3)


def test_it_learns_the_light_of_grey_frames(trained):
    images, neutrals = frames(60, 2)
    errors = degrees(trained.estimates(images), neutrals)
    guess = degrees(neutrals.mean(axis=0), neutrals)
    assert errors.mean() < 0.25 * guess.mean()


def test_the_weights_are_those_of_the_best_epoch(trained):
    images, neutrals = frames(160, 1)
    own = round(0.2 * 160)
    again = learner.error(trained.network, images[-own:], neutrals[-own:])
    assert again == pytest.approx(min(trained.validation), rel=1e-6)
    assert trained.validation[trained.epoch] == min(trained.validation)
    assert len(trained.validation) == 40


def test_a_seed_decides_everything(trained):
    images, _ = frames(8, 5)
    again = learner.train(*frames(160, 1), RULES, epochs=40, seed=3)
    other = learner.train(*frames(160, 1), RULES, epochs=40, seed=4)
    assert np.array_equal(trained.estimates(images), again.estimates(images))
    assert not np.allclose(trained.estimates(images), other.estimates(images))
