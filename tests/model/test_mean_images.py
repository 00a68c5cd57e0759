# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Coefficients of the planes of a CFA: of one curve, they are the same."""

import numpy as np
import pytest

from cg2raw.model.mean_images import coefficients_of, low_of, moved_by
from cg2raw.statistics.constant import PARTS, GroupInfo, polynomials
from cg2raw.statistics.frame_statistics import frame_statistics


@pytest.mark.parametrize("by", [-0.25, 0.25, 0.5])
@pytest.mark.parametrize("length", [24, 56])
def test_a_curve_that_is_sampled_elsewhere(length, by):
    along = np.arange(length)
    low = polynomials(length)

    def curve(place):
        return (place / length - 0.3) ** 5 - place / length + 0.5

    moved = moved_by(length, by) @ (low @ curve(along + by))
    assert moved == pytest.approx(low @ curve(along), abs=1e-9)


def test_noise_of_few_samples_stays_that_of_one():
    """36 planes of 16 x 21 samples, of white noise: moved to one place, coefficients
    would have three times as much."""
    rng = np.random.default_rng(3)
    frame = np.rint(rng.normal(1000.0, 30.0, (96, 126))).astype(np.uint16)
    found = frame_statistics([(GroupInfo("dark", ("a",)), [lambda: frame])], 6, 65535)
    planes = [coefficients_of(p, site, 6) for site, p in enumerate(found.planes)]
    for part, name in enumerate(PARTS[:-1]):
        if "fast" not in name:
            values = np.array([plane[part] for plane in planes]) / 30.0
            sure = 4 * np.sqrt(2 / values.size)
            assert np.mean(values**2) == pytest.approx(1, abs=sure), name


def test_planes_of_a_smooth_frame_are_alike():
    """A polynomial over the frame, in four planes: what is left is rounding."""
    down, across = np.mgrid[-1 : 1 : 96 * 1j, -1 : 1 : 128 * 1j]
    image = 2000 + 900 * across + 700 * down**2 + 500 * down * across**2
    frame = np.rint(image).astype(np.uint16)
    group = GroupInfo("flat", ("a",))
    found = frame_statistics([(group, [lambda: frame])], 2, 65535)
    first, *others = (
        coefficients_of(plane, site, 2) for site, plane in enumerate(found.planes)
    )
    low = [part for part, name in enumerate(PARTS[:-1]) if "fast" not in name]
    for other in others:
        for part in low:
            assert other[part] == pytest.approx(first[part], abs=2.0)
    assert np.abs(first[low[1]]).max() > 2e4  # of which 2 is little
    levels = [
        plane.level[0] + low_of(plane, site, 2)[0, 0, 0] / np.sqrt(48 * 64)
        for site, plane in enumerate(found.planes)
    ]
    assert np.ptp(levels) < 0.05  # of means that are 14 DN apart
    assert np.ptp([plane.level[0] for plane in found.planes]) > 10
