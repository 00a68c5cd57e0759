# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Parts of the translation: where it starts, what attention spares, what losses are."""

import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners import translation_networks as parts  # noqa: E402


def drawn(*shape, seed=0):
    return torch.rand(shape, generator=torch.Generator().manual_seed(seed))


def layers(last=0.0):
    """A generator whose last layer's weights are all one number."""
    found = parts.generator(8)
    torch.nn.init.constant_(found["last"].weight, last)
    return found


@pytest.mark.parametrize("size", [(16, 24), (17, 30)])
def test_it_starts_at_the_identity_at_any_size(size):
    images = drawn(2, 3, *size)
    assert torch.equal(parts.translated(layers(), images), images)
    assert not torch.allclose(parts.translated(layers(1.0), images), images)


def test_white_is_left_alone():
    """Attention is 0 where the luminance is 1."""
    images = drawn(1, 3, 16, 16)
    images[:, :, :8] = 1.0
    change = parts.translated(layers(1.0), images) - images
    assert change[:, :, :8].abs().max() == 0.0
    assert change[:, :, 8:].abs().max() > 1e-3


def test_a_discriminator_scores_patches():
    assert parts.discriminator(8)(drawn(2, 3, 64, 48)).shape == (2, 1, 8, 6)


def test_losses_are_those_of_the_paper():
    """By hand: scores 2 and 0 before a mean of 1, and 1 and 1 below a mean of 1."""
    better = torch.tensor([2.0, 0.0])
    worse = torch.tensor([1.0, 1.0])
    assert float(parts.relativistic(better, worse)) == pytest.approx(
        0.5 * ((0.0 + 4.0) / 2 + 0.0)
    )
    assert float(parts.squares(better, 1.0)) == pytest.approx(0.5)
    apart = parts.relativistic(worse + 1.0, worse)
    assert float(apart) == pytest.approx(0.5)  # the worse are 1 below, not level


def test_a_slope_is_that_of_a_plane():
    """Each score is 2 red + 3 blue of its pixel: 4 + 9, however many there are."""
    images = drawn(2, 3, 4, 5).requires_grad_()
    scores = 2.0 * images[:, 0] + 3.0 * images[:, 2]
    assert float(parts.slope(scores, images).detach()) == pytest.approx(13.0)


def test_content_is_luminance_of_any_scale():
    images = 0.1 + 0.5 * drawn(2, 3, 16, 16)
    turned = images[:, [1, 2, 0]] * 1.3 + 0.05
    other = 0.1 + 0.5 * drawn(2, 3, 16, 16, seed=1)
    assert float(parts.content_change(images, turned)) < 1e-4
    assert float(parts.content_change(images, other)) > 0.5
    flat = torch.full_like(images, 0.4)
    assert torch.isfinite(parts.content_change(flat, images))
