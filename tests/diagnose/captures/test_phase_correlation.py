# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Phase correlation: planted shifts of a picture, whatever its light and size."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.ndimage import shift as moved

from cg2raw.diagnose.captures.phase_correlation import (
    Shift,
    likeness,
    misplaced_words,
    shift_between,
    vertex,
    windowed,
)


def picture(shape=(180, 241), seed=1):
    """Return blobs of a few samples, brighter to one side."""
    rng = np.random.default_rng(seed)
    blobs = gaussian_filter(rng.normal(size=shape), 2.0)
    return blobs / blobs.std() + np.linspace(0, 2, shape[1])


@pytest.mark.parametrize(
    ("shifts", "is_said"),
    [
        ([(1.0, 0.0)] * 3, True),
        ([(0.0, -0.5)] * 3, True),
        ([(0.2, -0.2)] * 3, False),
        ([(0.0, 0.0), (0.1, 0.0), (3.0, 3.0)], False),  # of one alone
        ([], False),
    ],
)
def test_renders_beside_their_captures_need_registration(shifts, is_said):
    words = misplaced_words([Shift(*one, 0.9) for one in shifts])
    assert bool(words) == ("add registration to nuisance" in words) == is_said


@pytest.mark.parametrize("by", [(0, 0), (3, -5), (-7.4, 2.3), (0.5, 11.6)])
@pytest.mark.parametrize("light", [(1.0, 0.0), (1e-4, 50.0)])
def test_a_planted_shift(by, light):
    """An odd number of columns, and light that is weaker or on top of an offset."""
    first = picture()
    gain, offset = light
    found = shift_between(first, gain * moved(first, by, mode="nearest") + offset)
    assert (found.down, found.right) == pytest.approx(by, abs=0.1)
    assert found.correlation > 0.9


def test_an_offset_of_light_moves_nothing():
    first, second = picture(), moved(picture(), (3.3, -5.2), mode="nearest")
    found, lifted = shift_between(first, second), shift_between(first + 9, second)
    assert (lifted.down, lifted.right) == pytest.approx((found.down, found.right))
    assert windowed(first + 9) == pytest.approx(windowed(first), abs=1e-12)
    assert not windowed(first)[[0, -1]].any() and not windowed(first)[:, [0, -1]].any()


def test_another_picture_does_not_correlate():
    for seed in range(2, 8):
        assert abs(shift_between(picture(), picture(seed=seed)).correlation) < 0.5


def test_nothing_in_a_picture_is_no_shift():
    flat = np.full((20, 31), 0.3)
    assert shift_between(flat, flat) == Shift(0.0, 0.0, 0.0)
    for pair in [(flat, picture(flat.shape)), (picture(flat.shape), flat)]:
        assert shift_between(*pair).correlation == 0


def test_a_peak_is_that_of_a_gaussian():
    """Three samples of one are enough, also around the end of a line."""
    for peak, at in ((10, 10.3), (0, -0.4), (31, 30.8)):
        away = (np.arange(32) - at + 16) % 32 - 16
        line = np.exp(-(away**2) / 2)
        assert peak + vertex(line, peak) == pytest.approx(at, abs=1e-9)
    assert vertex(np.ones(8), 3) == 0.0


@pytest.mark.parametrize("noise", [0.1, 1.0, 2.5])
def test_likeness_is_the_correlation_over_what_noise_leaves(noise):
    rng = np.random.default_rng(1)
    render, other, chance = rng.standard_normal((3, 300, 400))
    capture = 5 + render + noise * chance
    assert likeness(capture, render, noise) == pytest.approx(1.05, abs=0.06)
    assert likeness(capture, other, noise) < 0.2


def test_a_render_without_contrast_is_like_a_capture_that_has_none():
    noise = np.random.default_rng(1).standard_normal((300, 400))
    flat = np.full(noise.shape, 2.0)
    assert likeness(flat + noise, flat, 1.0) == 1.0
    assert likeness(flat + 4 * noise, flat, 1.0) == 0.0
    assert likeness(flat, flat + noise, 0.1) < 0.1
