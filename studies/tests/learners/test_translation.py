# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Unpaired translation: it finds a planted colour matrix, and goes on where it was."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners.checkpoint import Checkpoint  # noqa: E402
from studies.learners.translation import Sets, train  # noqa: E402
from studies.protocol import PROTOCOL  # noqa: E402

RULES = replace(
    PROTOCOL.translation,
    record=4,
    batch=4,
    crop=32,
    patch=16,
    rate=4e-3,
    generator_rate=4e-3,
    average=0.05,
)
MATRIX = np.array([[0.6, 0.3, 0.1], [0.15, 0.7, 0.15], [0.05, 0.35, 0.6]], np.float32)
STEPS = 12


def frames(count, seed):
    """Frames (count, 36, 40, 3) of rectangles of drawn colours, 0..1."""
    rng = np.random.default_rng(seed)
    found = np.empty((count, 36, 40, 3), np.float32)
    for image in found:
        image[:] = rng.uniform(0.05, 0.9, 3)
        for _ in range(12):
            top, left = rng.integers(0, 30, 2)
            high, wide = rng.integers(4, 20, 2)
            colour = rng.beta(0.7, 0.9, 3)
            image[top : top + high, left : left + wide] = colour
    return found


def sets():
    """Renders, and captures of other scenes whose colours a matrix has changed."""
    return Sets(frames(60, 1), frames(60, 2) @ MATRIX.T, frames(60, 3) @ MATRIX.T)


@pytest.fixture(scope="module")
def learnt():
    return train(sets(), replace(RULES, record=150), 300, seed=3)


def test_it_finds_the_colours_of_a_planted_matrix(learnt):
    """Grey is the one colour that the matrix keeps: the renders are too colourful."""
    start, end = learnt.curve[0], learnt.curve[-1]
    assert start["chromaticities"] > 4.0 * learnt.floor["chromaticities"]
    assert end["chromaticities"] < 0.5 * start["chromaticities"]
    assert [point["step"] for point in learnt.curve] == [0, 150, 300]


def test_it_keeps_the_content(learnt):
    images = frames(10, 4)
    for before, after in zip(images, learnt(list(images)), strict=True):
        assert np.corrcoef(before.mean(2).flat, after.mean(2).flat)[0, 1] > 0.9


def test_it_is_nearer_to_the_matrix_than_the_render_is(learnt):
    """Frame by frame, though no frame was ever seen in both colours."""
    images = frames(10, 4)
    apart = [np.abs(found - images @ MATRIX.T).mean() for found in (images, of(learnt))]
    assert apart[1] < 0.9 * apart[0]


def of(trained):
    return np.stack(trained(list(frames(10, 4))))


def test_images_are_finite_and_not_negative(learnt):
    odd = [
        np.zeros((36, 40, 3)),
        np.ones((36, 40, 3)),
        np.eye(3)[2] * np.ones((9, 7, 1)),
    ]
    for image in odd:
        (found,) = learnt([image.astype(np.float32)])
        assert found.shape == image.shape and found.dtype == np.float32
        assert np.isfinite(found).all() and found.min() >= 0.0
    assert learnt([]) == []


def test_a_seed_decides_everything():
    one, again, other = (train(sets(), RULES, STEPS, seed) for seed in (3, 3, 4))
    assert of(one).tobytes() == of(again).tobytes()
    assert one.curve == again.curve
    assert not np.allclose(of(one), of(other), atol=1e-7)


class Stopped(Checkpoint):
    """A checkpoint whose training is killed after the record of step 8."""

    def write(self, state):
        super().write(state)
        if state["step"] == 8:
            raise KeyboardInterrupt


def test_it_goes_on_to_the_weights_of_a_training_without_a_stop(tmp_path):
    whole = train(sets(), RULES, STEPS, seed=3)
    path = tmp_path / "a.pt"
    with pytest.raises(KeyboardInterrupt):
        train(sets(), RULES, STEPS, seed=3, checkpoint=Stopped(path, "key"))
    resumed = train(sets(), RULES, STEPS, seed=3, checkpoint=Checkpoint(path, "key"))
    assert of(resumed).tobytes() == of(whole).tobytes()
    assert resumed.curve == whole.curve
    assert Checkpoint(path, "key").read()["step"] == STEPS
