# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Correlations of neighbours, and what made them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import convolve

from cg2raw.model.fit import fit
from cg2raw.model.lags import (
    Blended,
    lag_gains,
    lags_of,
    shared_by,
    variance_left,
    variance_left_of_lines,
)
from cg2raw.model.planes import neighbours
from cg2raw.statistics.constant import LAGS, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from tiers import first_fast

LEAST, NONE = 8.0, dict.fromkeys(("ratios", "errors", "of"), np.zeros(0))
SHAPE, READ, GAIN = (120, 160), 6.0, 0.4  # DN, DN per electron


def blended(image, blend, diagonal, side):
    kernel = np.zeros((2 * side + 1, 2 * side + 1))
    kernel[::side, ::side] = diagonal / 4
    kernel[side, ::side] = kernel[::side, side] = blend / 4
    kernel[side, side] = 1 - blend - diagonal
    return convolve(image, kernel, mode="wrap")


def halves(rng, side, link=0.0, blend=0.0, diagonal=0.0):
    """Two splits of six darks and six flats each."""

    def frame(light):
        noise = rng.standard_normal((SHAPE[0], SHAPE[1] + 1))
        a = (1 - np.sqrt(1 - 4 * link**2)) / (2 * link) if link else 0.0
        read = READ * (noise[:, 1:] + a * noise[:, :-1]) / np.sqrt(1 + a * a)
        shot = np.sqrt(GAIN * light) * rng.standard_normal(SHAPE)
        image = blended(light + read + shot, blend, diagonal, side)
        return np.rint(500 + image).astype(np.uint16)

    for _ in range(2):
        groups = [
            (GroupInfo(kind, tuple("abcdef"), 0.0), [frame(light) for _ in range(6)])
            for kind, light in (("dark", 0.0), ("flat", 1500.0))
        ]
        readers = [(info, [lambda f=f: f for f in of]) for info, of in groups]
        statistics = frame_statistics(readers, side, 65535)
        found = fit(statistics)
        profile, at = np.zeros(len(found.parameters)), found.parameters.of
        for site in range(side**2):
            profile[at("read_noise", site)] = READ**2
            profile[at("gain", site)] = GAIN
        yield lags_of(statistics, found, profile)


@pytest.mark.parametrize("side", first_fast([2, 1], 1))
@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({}, set()),
        ({"link": 0.05}, {"read_noise_correlation"}),
        ({"link": -0.05}, {"read_noise_correlation"}),
        ({"blend": 0.06}, {"noise_reduction"}),
        ({"blend": 0.2, "diagonal": 0.1}, {"noise_reduction"}),
        (
            {"link": 0.1, "blend": 0.2},
            {"read_noise_correlation", "noise_reduction"},
        ),
    ],
)
def test_what_made_them_is_named(side, given, names):
    rng = np.random.default_rng(11)
    (gains, _), values, covariance = lag_gains(*halves(rng, side, **given), LEAST)
    assert {name for name, gain in gains.items() if gain > LEAST} == names
    wanted = [given.get(name, 0.0) for name in ("link", "blend", "diagonal")]
    if len(names) == 1:
        errors = np.sqrt(np.diagonal(covariance)) + 2e-3
        assert np.abs(values - wanted).max() < 4 * errors.max()


def test_a_weak_one_is_told_by_what_it_leaves_of_noise():
    """0.02 of the neighbours: 4 % less variance of read and photon noise alike."""
    first, second = halves(np.random.default_rng(12), 2, blend=0.02)
    (gains, _), values, covariance = lag_gains(first, second, LEAST)
    assert gains["noise_reduction"] > LEAST
    left = Blended.of(first, values, covariance)
    assert left.left == pytest.approx(variance_left(0.02, 0.0), abs=4 * left.error)


def test_what_the_profile_states_is_no_gain():
    """And what is beyond it, is."""
    rng, given = np.random.default_rng(16), {"blend": 0.2, "diagonal": 0.1}
    for stated, gains in ((0.2, False), (0.1, True)):
        both = [
            replace(one, null=np.array([0.0, stated, 0.1]), **NONE)
            for one in halves(rng, 2, **given)
        ]
        assert (lag_gains(*both, LEAST)[0].gains["noise_reduction"] > LEAST) == gains


def test_less_of_one_noise_alone_is_no_noise_reduction():
    first, second = halves(np.random.default_rng(13), 2)
    for one in (first, second):
        one.ratios[:4] -= 0.1  # read noise, of four sites
    assert lag_gains(first, second, LEAST)[0].gains["noise_reduction"] < LEAST


def test_weak_shot_noise_is_no_noise_reduction():
    """4.8 % less of it, in frames of 112 x 144 px: sites are off by chance, and what
    each was in training says less than what all have in common."""
    ratios = (
        (0.009, -0.004, 0.010, -0.021, -0.055, -0.023, -0.057, -0.052),
        (-0.022, -0.022, -0.007, -0.004, -0.042, -0.059, -0.025, -0.031),
    )
    small = [
        replace(
            one,
            ratios=np.array(of_split),
            errors=np.full(8, 0.012),
            measured=one.expected(np.array([0.0, *blend])),
            samples=np.full(2, 2 * 112 * 144.0),
        )
        for one, of_split, blend in zip(
            halves(np.random.default_rng(13), 2),
            ratios,
            ((0.008, 0.006), (0.0, 0.0)),
            strict=True,
        )
    ]
    assert lag_gains(*small, LEAST)[0].gains["noise_reduction"] < LEAST


@pytest.mark.parametrize(("blend", "diagonal"), [(0.1, 0.0), (0.3, 0.2), (0.0, 0.3)])
def test_correlations_are_those_of_blended_noise(blend, diagonal):
    rng = np.random.default_rng(14)
    image = blended(rng.standard_normal((600, 800)), blend, diagonal, 1)
    assert image.var() == pytest.approx(variance_left(blend, diagonal), rel=0.01)
    lines = blended(rng.standard_normal((900, 1)) + np.zeros(40), blend, diagonal, 1)
    left = variance_left_of_lines(blend, diagonal)
    assert lines.var() == pytest.approx(left, rel=0.15)
    assert left > image.var()
    for (down, across), value in np.ndenumerate(shared_by(blend, diagonal)):
        moved = np.roll(image, (down - 2, across - 2), (0, 1))
        assert (image * moved).mean() / image.var() == pytest.approx(value, abs=5e-3)


@pytest.mark.parametrize("side", [1, 2])
def test_white_noise_has_none(side):
    """On average over frames; the means of lines that are taken off would leave some
    of each lag, if it were not put back."""
    rng = np.random.default_rng(15)
    shape = (60 * side, 80 * side)
    frames = [np.rint(500 + 9 * rng.standard_normal(shape)) for _ in range(100)]
    readers = [lambda f=f: f.astype(np.uint16) for f in frames]
    info = GroupInfo("dark", tuple(str(n) for n in range(100)))
    found = frame_statistics([(info, readers)], side, 65535)
    error = 1 / np.sqrt(50 * shape[0] * shape[1])
    lost = 1 / 60 + 25 / 4800  # of what is put back, a tenth may be missing
    for lag in LAGS:
        assert abs(neighbours(found, *lag)[0]) < 4 * error + lost / 10, lag
    assert neighbours(found, 0, 3) is None  # which is not measured


def test_lines_of_three_samples_show_no_neighbours():
    frames = np.random.default_rng(2).integers(90, 110, (4, 3, 50), np.uint16)
    info = GroupInfo("dark", ("a", "b", "c", "d"))
    found = frame_statistics([(info, [lambda f=f: f for f in frames])], 1, 65535)
    assert all(neighbours(found, *lag) == 0 for lag in LAGS)
