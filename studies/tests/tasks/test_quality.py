# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""PSNR and SSIM by what is known of them."""

import numpy as np
import pytest

from studies.tasks.quality import averaging, psnr, ssim


def planes(seed=1, size=(20, 24)):
    return np.random.default_rng(seed).random((2, 4, *size)).astype(np.float32)


@pytest.mark.parametrize(("error", "decibels"), [(0.1, 20.0), (0.01, 40.0), (1.0, 0.0)])
def test_psnr_of_one_error_everywhere(error, decibels):
    zeros = np.zeros((2, 4, 5, 5), np.float32)
    found = psnr(zeros + np.float32(error), zeros)
    assert found == pytest.approx([decibels] * 2, abs=1e-5)


def test_the_same_planes_have_ssim_1():
    assert ssim(planes(), planes(), 1.0) == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize(
    ("one", "other", "value"),
    [  # (2 a b + c1) / (a^2 + b^2 + c1), c1 = 1e-4: what is left of SSIM without detail
        (0.5, 0.5, 1.0),
        (0.5, 0.25, 0.2501 / 0.3126),
        (0.1, 0.9, 0.1801 / 0.8201),
        (0.0, 0.1, 0.0001 / 0.0101),
    ],
)
def test_ssim_of_two_levels(one, other, value):
    x, y = (np.full((1, 4, 12, 13), level, np.float32) for level in (one, other))
    assert ssim(x, y, 1.0) == pytest.approx([value], rel=1e-4)


def test_ssim_is_the_papers_formula_in_each_window():
    """Equations 13 to 16 of Wang et al. 2004, one window after the other."""
    x, y = (planes(seed)[0, 0].astype(float) for seed in (1, 2))
    rows, columns = np.mgrid[-5:6, -5:6]
    w = np.exp(-(rows**2 + columns**2) / (2 * 1.5**2))
    w /= w.sum()
    found = []
    for row in range(20 - 10):
        for column in range(24 - 10):
            a, b = (v[row : row + 11, column : column + 11] for v in (x, y))
            ma, mb = (w * a).sum(), (w * b).sum()
            va, vb = (w * (a - ma) ** 2).sum(), (w * (b - mb) ** 2).sum()
            both = (w * (a - ma) * (b - mb)).sum()
            found.append(
                (2 * ma * mb + 1e-4)
                * (2 * both + 9e-4)
                / ((ma**2 + mb**2 + 1e-4) * (va + vb + 9e-4))
            )
    four = (np.repeat(v[None, None], 4, axis=1).astype(np.float32) for v in (x, y))
    assert ssim(*four, 1.0) == pytest.approx([np.mean(found)], rel=1e-6)


def test_ssim_falls_with_noise():
    clean, rng = planes(), np.random.default_rng(5)
    noise = rng.standard_normal(clean.shape).astype(np.float32)
    found = [np.mean(ssim(clean + s * noise, clean, 1.0)) for s in (0.01, 0.05, 0.2)]
    assert 1.0 > found[0] > found[1] > found[2]


def test_a_dark_frame_is_judged_as_if_bright():
    clean, restored = planes(1), planes(2)
    bright = ssim(restored, clean, 1.0)
    dark = ssim(restored * np.float32(0.03), clean * np.float32(0.03), 0.03)
    assert dark == pytest.approx(bright, rel=1e-5)


def test_windows_weigh_1_in_all():
    assert averaging(30).sum(axis=0) == pytest.approx(np.ones(20))
