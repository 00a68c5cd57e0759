# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Moments of codes, against published series and against drawn samples."""

import numpy as np
import pytest

from cg2raw.model.recorded import (
    FINE_CODES,
    Offsets,
    Profiles,
    Recording,
    _with_ends,
    differences,
    fine_records,
    recorded,
    recorder_of,
)
from cg2raw.statistics.constant import PLACES

WHITE = 4095
EVEN = Profiles(np.zeros(1), np.zeros(1))  # lines are all alike


@pytest.mark.parametrize("sigma", [0.25, 0.4, 0.8])
@pytest.mark.parametrize("place", [0.0, 0.2, 0.5])
def test_moments_are_those_of_sheppards_series(sigma, place):
    """Mean and second moment about it by the Fourier series of rounding (B. Widrow,
    I. Kollar, Quantization Noise, 2008, 4.2): five terms leave 1e-30."""
    mean = 100 + place
    k = np.arange(1, 6)
    damped = np.exp(-2 * np.pi**2 * k**2 * sigma**2) * (-1.0) ** k
    error = (damped / (np.pi * k) * np.sin(2 * np.pi * k * mean)).sum()
    square = 1 / 12 + (damped / (np.pi * k) ** 2 * np.cos(2 * np.pi * k * mean)).sum()
    with_signal = 2 * sigma**2 * (damped * np.cos(2 * np.pi * k * mean)).sum() * 2
    (of_codes,), (spread,) = recorded(np.array([mean]), sigma**2, WHITE)
    assert of_codes == pytest.approx(mean + error, abs=1e-9)
    variance = sigma**2 + square + with_signal - error**2
    assert spread == pytest.approx(variance, rel=1e-8)


def test_codes_of_black_at_zero_are_cut():
    """Half of a normal distribution about 0 has the mean sigma / sqrt(2 pi) and the
    variance (1 / 2 - 1 / (2 pi)) sigma^2, if codes are fine: 1/50 sigma here."""
    (mean,), (variance,) = recorded(np.array([0.0]), 50.0**2, 10**6)
    assert mean == pytest.approx(50 / np.sqrt(2 * np.pi), rel=1e-3)
    assert variance == pytest.approx((0.5 - 0.5 / np.pi) * 50**2, rel=1e-3)


@pytest.mark.parametrize(
    ("sigma", "steps", "apart"),
    [(0.2, 128, 1), (0.6, 64, 1), (0.8, 64, 1), (3.0, 16, 1), (90.0, 1, 2)],
)
def test_a_grid_has_the_moments_of_its_signals(sigma, steps, apart):
    """From below 0 to above white; fine codes have theirs within 1e-4, and those of
    wide noise within 1e-5 of its variance."""
    whole = np.arange(-20, 92, apart)
    grid = np.linspace(-20, whole[-1], (len(whole) - 1) * steps + 1)
    found = _with_ends(whole, steps, sigma**2, 64)
    for own, other in zip(found, recorded(grid, sigma**2, 64), strict=True):
        most = 1e-10 if sigma**2 < 0.54 else max(1e-4, 1e-5 * sigma**2 * (sigma > 30))
        near = 1e-10 if sigma < 30 else most
        np.testing.assert_allclose(own, other, rtol=0, atol=most)
        np.testing.assert_allclose(own[grid < 2], other[grid < 2], rtol=0, atol=near)


def test_white_is_the_mirror_of_zero():
    low = recorded(np.array([0.3]), 0.5, WHITE)
    high = recorded(np.array([WHITE - 0.3]), 0.5, WHITE)
    assert WHITE - high[0][0] == pytest.approx(low[0][0])
    assert high[1][0] == pytest.approx(low[1][0])


@pytest.mark.parametrize(
    ("black", "drift", "lines", "fixed", "frames", "charged"),
    [
        (64.0, 0.0, 0.1, 0.2, 40, 0.0),
        (64.3, 0.2, 0.1, 0.2, 40, 0.0),
        (0.2, 0.2, 0.1, 0.2, 40, 0.0),
        (64.0, 0.0, 0.2, 0.05, 40, 0.0),
        (64.0, 0.0, 0.12, 0.05, 4, 0.0),  # the mean of rows is half of each frame's
        (64.4, 0.14, 0.01, 0.05, 40, 0.0),  # quiet: variance is of where frames are
        (64.3, 0.0, 0.01, 0.1, 40, 0.1),
    ],
)
def test_a_group_is_what_is_drawn(black, drift, lines, fixed, frames, charged):
    """Place, variance, response and excess of 600 x 60 pixels whose rows have offsets
    of their own in each frame and whose levels drift; the tolerances are four standard
    errors of these draws. charged : of the last, whose noise grows with its offsets."""
    rng = np.random.default_rng(5)
    sigma, shape = 0.3 if fixed > 0.1 else 0.2, (600, 60)
    pattern = fixed * rng.standard_normal(shape)
    levels = drift * rng.standard_normal((frames, 1, 1))
    levels -= levels.mean()
    offsets = pattern + levels + lines * rng.standard_normal((frames, shape[0], 1))
    noise = np.sqrt(np.maximum(sigma**2 + charged * pattern, 0))
    noise = noise * rng.standard_normal((frames, *shape))
    codes = np.clip(np.rint(black + offsets + noise), 0, WHITE)
    about = Offsets(sigma**2, lines**2, fixed**2, charged)
    levels, rows = codes.mean(axis=(1, 2)), codes.mean(axis=(0, 2))
    places = np.quantile(rows - rows.mean(), PLACES)
    profiles = Profiles(rows - rows.mean(), np.zeros(60))
    given = levels, places, profiles, about, codes.var(), WHITE, black < 9
    recorder = recorder_of(*given)
    values, slopes = recorder(about)
    found = Recording(*values)
    assert found.place == pytest.approx(black, abs=0.01)
    rest = codes - codes.mean(axis=0) - codes.mean(axis=2, keepdims=True)
    rest += rows[:, None]
    variance = (rest**2).sum() / (frames - 1) / (shape[1] - 1) / shape[0]
    assert found.variance == pytest.approx(variance, rel=0.04 if frames < 9 else 0.015)
    means = codes.mean(axis=0) - rows[:, None]
    power = means.var() * shape[1] / (shape[1] - 1)
    response = (means * pattern).mean() / (pattern - pattern.mean(1)[:, None]).var()
    assert found.fixed == pytest.approx(response, abs=0.02)
    left = power - variance / frames - response**2 * fixed**2
    assert found.steps == pytest.approx(left, abs=8e-4)
    for n, name in enumerate(Offsets._fields[:3]):
        more = about._replace(**{name: about[n] + 1e-5})
        by_steps = (recorder(more)[0] - values) / 1e-5
        np.testing.assert_allclose(slopes[:, n], by_steps, rtol=1e-2, atol=2e-3)


def test_noise_that_neighbours_have_in_common_is_recorded_by_both():
    """Covariance of codes of pixels whose fixed offsets are their own."""
    rng, sigma, fixed, common = np.random.default_rng(6), 0.2, 0.2, 0.2
    shape = 2, 20, 100_000
    shared, own = rng.standard_normal(shape[1:]), rng.standard_normal(shape)
    noise = sigma * (np.sqrt(common) * shared + np.sqrt(1 - common) * own)
    offsets = fixed * rng.standard_normal((2, 1, shape[2]))
    codes = np.rint(64.3 + offsets + noise)
    level = codes.mean(keepdims=True).ravel()
    codes -= codes.mean(axis=1, keepdims=True)
    covariance = (codes[0] * codes[1]).mean() * shape[1] / (shape[1] - 1)
    about = Offsets(sigma**2, 0.0, fixed**2)
    one = recorder_of(level, np.zeros(1), EVEN, about, 0.2, WHITE, False)
    found = Recording(*one(about)[0]).across ** 2
    assert found == pytest.approx(covariance / (common * sigma**2), rel=0.1)


def test_lines_are_recorded_by_where_all_of_their_pixels_are():
    """Rows cross columns that are all over a code, columns lie each in one place; the
    next column lies elsewhere, the next row does not. Of 40 frames of 300 x 300."""
    rng, sigma, moved = np.random.default_rng(8), 0.2, 0.08
    size, frames = 300, 40
    columns = np.tile(0.3 * np.sin(0.5 * np.arange(size)), (size, 1))
    of_rows, of_columns = moved * rng.standard_normal((2, frames, size))
    signal = 64.3 + columns + of_rows[:, :, None] + of_columns[:, None]
    noise = sigma * rng.standard_normal((frames, size, size))
    codes = np.rint(signal + noise)
    levels, mean = codes.mean(axis=(1, 2)), codes.mean(axis=0)
    mean -= mean.mean()
    about = Offsets(sigma**2, 2 * moved**2, 0.0)
    profiles = Profiles(mean.mean(axis=1), mean.mean(axis=0))
    places = np.quantile(mean, PLACES)
    one = recorder_of(levels, places, profiles, about, codes.var(), WHITE, False)
    found = Recording(*one(about)[0])
    rest = codes - codes.mean(axis=0)
    for axis, moves, response in (
        (2, of_rows, found.rows),
        (1, of_columns, found.columns),
    ):
        lines = rest.mean(axis=axis)
        lines -= lines.mean(axis=1, keepdims=True)
        power = lines.var() * frames / (frames - 1) - rest.var() / size
        assert response == pytest.approx(np.sqrt(power / moves.var()), rel=0.02)
    assert found.columns > 1.05 * found.rows
    # What rows are recorded by where columns are, next columns have in common in part.
    rest -= rest.mean(axis=2, keepdims=True)
    rest -= rest.mean(axis=1, keepdims=True)
    power = (rest[:, :, 1:] * rest[:, :, :-1]).mean() * frames / (frames - 1)
    assert power == pytest.approx(of_rows.var() * found.in_rows, rel=0.1)
    assert found.down > 1.03 * found.across


@pytest.mark.parametrize("sigma", [0.5, 0.9, 1.2, 1.5])
def test_lines_of_darks_that_are_half_zero(sigma):
    """Of columns whose offsets are normal, rows record the mean slope, and columns the
    root of its mean square."""
    columns = 0.3 * sigma * np.random.default_rng(3).standard_normal(4000)
    codes, _ = recorded(columns, sigma**2, WHITE)
    profiles = Profiles(np.zeros(1), codes - codes.mean())
    places, level = np.quantile(profiles.columns, PLACES), codes.mean()
    levels, about = level + np.array([-0.01, 0.0, 0.01]), Offsets(sigma**2, 1e-4, 1e-4)
    given = levels, places, profiles, about, sigma**2, WHITE, True
    found = Recording(*recorder_of(*given)(about)[0])
    # The mean code rises at each edge of codes by the density there.
    steps = (np.arange(0.5, 12) - columns[:, None]) / sigma
    slopes = np.exp(-(steps**2) / 2).sum(axis=1) / np.sqrt(2 * np.pi) / sigma
    assert found.rows == pytest.approx(slopes.mean(), abs=5e-3)
    assert found.columns == pytest.approx(np.sqrt((slopes**2).mean()), abs=5e-3)


def test_two_frames_have_a_spread_of_response():
    """The variance of two is half the square of by how much they differ."""
    about = Offsets(0.04, 0.0, 0.01)
    each = []
    for level in (64.1, 64.5):
        one = recorder_of(
            np.full(1, level), np.zeros(1), EVEN, about, 0.1, WHITE, False
        )
        each.append(Recording(*one(about)[0]).fixed)
    both = np.array([64.1, 64.5])
    values, _ = recorder_of(both, np.zeros(1), EVEN, about, 0.1, WHITE, False)(about)
    assert Recording(*values).fading == pytest.approx(
        (each[1] - each[0]) ** 2 / 2, rel=0.1
    )


def test_fine_codes_need_no_table():
    about, levels, places = Offsets(4.0, 0.1, 0.1), np.full(1, 200.0), np.zeros(1)
    one = recorder_of(levels, places, EVEN, about, 4.0, WHITE, False)
    assert one.table is None and one.unrounded(4.0) == 4.0 - 1 / 12
    values, slopes = fine_records(levels, np.array([4.0]), np.array([[0.0, 1.0]]))
    fine = FINE_CODES._replace(place=200.0, variance=4.0 + 1 / 12)
    assert Recording(*np.array(values)[:, 0]) == fine
    assert np.sum(slopes) == slopes.variance[0, 1] == 1
    table = recorder_of(levels, places, EVEN, about, 0.6, WHITE, False)
    np.testing.assert_allclose(table(about)[0], fine, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("variance", [0.04, 0.1, 0.4])
def test_noise_is_estimated_from_the_variance_of_its_codes(variance):
    about, levels, places = Offsets(0.1, 0.01, 0.01), np.full(1, 20.1), np.zeros(1)
    one = recorder_of(levels, places, EVEN, about, 0.1, WHITE, False)
    coded = Recording(*one(about._replace(noise=variance))[0]).variance
    assert one.unrounded(coded) == pytest.approx(variance, rel=1e-3)


@pytest.mark.parametrize(("variance", "share", "ratio"), [(0.3, 0, 1), (4, 0.1, 9)])
def test_differences_of_two_codes(variance, share, ratio):
    """Their mean square is twice the variance and rounding's, over all places."""
    found = differences(np.arange(16) / 16, variance, share, ratio)
    np.testing.assert_allclose(found.sum(axis=1), 1, atol=1e-12)
    squares = float((found @ np.arange(found.shape[1]) ** 2).mean())
    whole = variance * (1 + share * (ratio - 1)) + 1 / 12
    assert squares == pytest.approx(2 * whole, rel=2e-3)
