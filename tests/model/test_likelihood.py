# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Laws of the likelihood and its fit."""

import warnings

import numpy as np
import pytest

from cg2raw.model.components import FIXED
from cg2raw.model.evaluation import Evaluation
from cg2raw.model.figures import figures_of
from cg2raw.model.fit import fit, start_of
from cg2raw.model.likelihood import Likelihood
from cg2raw.model.planes import less_of, unshared
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from model.planted import planted
from oracles.plain_statistics import plain_statistics


@pytest.fixture(scope="module", params=[(1, False), (1, True), (2, False)])
def likelihood(request):
    side, low = request.param
    made = planted(11, low=low, shape=(64, 80), side=side, black=16)
    return Likelihood(made.statistics)


def test_the_score_is_the_slope_of_the_value(likelihood):
    """By differences of the value, a thousandth of a standard error to each side."""
    theta, free = start_of(likelihood)
    found = likelihood(theta)
    scale = 1 / np.sqrt(np.diagonal(found.information) + 1e-300)
    names = likelihood.parameters.names
    for at in np.flatnonzero(free & (np.diagonal(found.information) > 0)):
        step = np.zeros(len(theta))
        step[at] = 1e-3 * scale[at]
        rise = likelihood(theta + step).value - likelihood(theta - step).value
        slope = rise / 2e-3  # nats per standard error
        expected = found.score[at] * scale[at]
        assert slope == pytest.approx(expected, rel=0.02, abs=0.02), names[at]


def test_the_information_is_that_of_the_score(likelihood):
    """It has no negative direction, and steps of scoring end where the score is 0."""
    theta, free = start_of(likelihood)
    used = np.flatnonzero(free)
    information = likelihood(theta).information[np.ix_(used, used)]
    scale = 1 / np.sqrt(np.diagonal(information) + 1e-300)
    assert np.linalg.eigvalsh(information * np.outer(scale, scale)).min() > -1e-9


def test_a_fit_ends_where_the_score_is_zero():
    found = fit(planted(12, shape=(64, 80)).statistics)
    end = found.likelihood(found.theta)
    known = np.isfinite(np.diagonal(found.covariance))
    error = np.sqrt(np.diagonal(found.covariance))
    inside = known & ~(found.parameters.are_bounded & (found.theta == 0))
    assert np.abs(end.score * error)[inside].max() < 0.05  # of a standard error
    assert end.score[known & ~inside].max() < 0  # at their bound


def test_the_score_has_no_step_where_a_pattern_is_none():
    """Of few codes, which record a pattern the more the wider it is: no kink at 0, at
    which a fit would stay."""
    found = Likelihood(planted(11, low=True, noise=0.25, black=16).statistics)
    theta, _ = start_of(found)
    for name in ("dsnu", "row_noise"):
        at = found.parameters.of(name)
        error = 1 / np.sqrt(found(theta).information[at, at])
        scores = []
        for side in (-1e-3, 1e-3):
            theta[at] = side * error
            scores.append(found(theta).score[at] * error)
        assert scores[1] == pytest.approx(scores[0], rel=5e-3), name


@pytest.mark.parametrize("seed", [5, 6])
def test_read_noise_about_whole_codes(seed):
    """0.21 DN, of which codes hide half: errors have what patterns may hide."""
    rng, groups = np.random.default_rng(seed), []
    for kind, seconds, light in (
        ("dark", 0.0, 0.0),
        ("dark", 10.0, 0.0),
        ("flat", 1.0, 150.0),
        ("flat", 1.0, 500.0),
    ):
        info = GroupInfo(kind, ("a", "b"), seconds)
        noise = np.sqrt(0.21**2 + 0.05 * light) * rng.standard_normal((2, 96, 112))
        codes = np.rint(16 + light + noise).astype(np.uint16)
        groups.append((info, [lambda f=f: f for f in codes]))
    found = fit(frame_statistics(groups, 2, 1023))
    assert found.is_settled
    for site in range(4):
        value, error = found.of("read_noise", site)
        assert abs(value - 0.21**2) < 2.5 * error < 0.1 * value


def test_the_value_is_of_what_is_measured_over_what_is_expected():
    """0 where both are the same, whatever the freedom."""
    found, measured = Evaluation(1), np.array([0.1, 3.0])
    found.add_chi_square(measured, measured, np.ones((2, 1)), np.array([10.0, 2e4]))
    assert found.value == 0
    found.add_chi_square(measured, 2 * measured, np.ones((2, 1)), np.array([10.0, 0.0]))
    assert found.value == pytest.approx(-5 * (np.log(2) - 0.5))


def test_values_are_the_same_in_other_units():
    """Frames with all times in ms in place of s: the same nats, rates a thousandth."""
    made = planted(13, shape=(64, 80))
    slow = [
        (type(info)(info.kind, info.frames, 1000 * info.exposure_time), frames)
        for info, frames in made.groups
    ]
    one, other = fit(made.statistics), fit(made._replace(groups=slow).statistics)
    assert other.value == pytest.approx(one.value, abs=1e-4)
    rate = one.of("dark_current")[0]
    assert other.of("dark_current")[0] == pytest.approx(rate / 1000, rel=1e-4)
    assert other.of("prnu")[0] == pytest.approx(one.of("prnu")[0], rel=1e-4)


def test_groups_of_two_splits_are_fitted_together():
    """The frames of each group dealt to two: errors are those of all frames."""
    made = planted(14, shape=(64, 80))
    dealt = [
        (type(info)(info.kind, info.frames[k::2], info.exposure_time), frames[k::2])
        for info, frames in made.groups
        for k in (0, 1)
    ]
    one, two = fit(made.statistics), fit(made._replace(groups=dealt).statistics)
    for name in ("read_noise", "gain", "prnu", "dsnu"):
        (value, error), (again, wider) = one.of(name), two.of(name)
        assert again == pytest.approx(value, abs=1.5 * error), name
        assert wider == pytest.approx(error, rel=0.25), name


def test_darks_alone_show_no_light():
    made = planted(15, shape=(64, 80))
    darks = [group for group in made.groups if group[0].kind == "dark"]
    found = fit(made._replace(groups=darks).statistics)
    for name in ("prnu", "columns of light"):
        assert np.isnan(found.of(name)[0])
    assert np.isfinite(found.of("dark_current_nonuniformity")[0])


def test_biases_alone():
    made = planted(16, shape=(64, 80))
    found = fit(made._replace(groups=made.groups[:1]).statistics)
    value, error = found.of("read_noise")
    assert np.sqrt(value) == pytest.approx(made.truth["read noise 0"], abs=4 * error)
    for name in (
        "gain",
        "dark_current",
        *(c.name for c in FIXED if c.signature != "constant"),
    ):
        assert np.isnan(found.of(name)[0]), name


def test_single_frames_tell_noise_by_what_they_do_not_share(monkeypatch):
    """Darks of four times and flats of two lights, a frame of each: of 28 z by noise,
    patterns and lines in 4 sets a root mean square above 1.5 has a chance of 1 %."""
    monkeypatch.setattr("model.planted.TIMES", (0.0, 5.0, 10.0, 20.0))
    monkeypatch.setattr("model.planted.FRAMES", 1)
    names = ("read noise 0", "row noise", "DSNU", "fixed column pattern")
    names += ("dark current nonuniformity", "PRNU", "gain 0")
    z = []
    for seed in range(4):
        made = planted(seed, shape=(96, 128))
        statistics = made.statistics
        for one in figures_of(statistics, fit(statistics)):
            name = one.name if one.site is None else f"{one.name} {one.site}"
            if name in names:
                z.append((one.value - made.truth[name]) / one.standard_error)
    assert len(z) == 4 * len(names)
    assert np.sqrt(np.mean(np.square(z))) < 1.5


def test_a_single_frame_is_refused():
    made = planted(17, shape=(64, 80))
    info, frames = made.groups[0]
    with pytest.raises(ValueError, match="no two repeat each other, and all are of"):
        fit(made._replace(groups=[(info, frames[:1])]).statistics)


@pytest.mark.parametrize("side", [1, 2])
def test_correlated_noise_is_no_row_noise(side):
    """Neighbours that share a third of their variance: means of rows vary 1.67 times as
    much as those of white noise, and no row has an offset of its own: neither new in
    each frame nor always."""
    rng = np.random.default_rng(18)
    noise = rng.standard_normal((8, 192, 81))
    noise = (noise[:, :, 1:] + 0.382 * noise[:, :, :-1]) / np.sqrt(1 + 0.382**2)
    frames = list(np.rint(300 + 6 * noise).astype(np.uint16))
    info = GroupInfo("dark", tuple("abcdefgh"), 0.0)
    found = fit(plain_statistics([(info, frames)], side, 4095))
    for name in ("row_noise", "row_fixed_pattern"):
        value, error = found.of(name)
        assert abs(value) < 3 * error, (name, value, error)


def test_what_images_do_not_share():
    """Three images: what a regression of each on the others leaves of its variance."""
    products = np.array([[4.0, 2.0, 1.0], [2.0, 9.0, 0.5], [1.0, 0.5, 2.0]])
    for n, found in enumerate(unshared(products)):
        others = [k for k in range(3) if k != n]
        among, with_it = products[np.ix_(others, others)], products[others, n]
        left = products[n, n] - with_it @ np.linalg.solve(among, with_it)
        assert found == pytest.approx(left)


@pytest.mark.parametrize(("count", "power"), [(3, 4.0), (8, 0.5), (8, 30.0), (32, 5.0)])
def test_freedom_of_what_few_numbers_move(count, power):
    """Coefficients of noise 1 and of a wave by two numbers, whose power each has on
    average: the freedom of a sum of squares is the square of the trace of their
    covariance over the trace of its square (F. Satterthwaite, Biometrics 2, 1946)."""
    two = np.linalg.qr(np.random.default_rng(count).standard_normal((count, 2)))[0]
    covariance = np.eye(count) + power * count / 2 * two @ two.T
    freedom = np.trace(covariance) ** 2 / np.trace(covariance @ covariance)
    assert count * less_of(1 + power, 1.0, count / 2) == pytest.approx(freedom)


@pytest.mark.parametrize(
    ("groups", "words"),
    [
        ([(1, 100)], "no two repeat each other"),
        ([(3, 100), (3, 4095)], "1-0: has the same pixels as its 2 repeats, or all"),
    ],
)
def test_frames_that_show_no_noise_are_refused(groups, words):
    rng = np.random.default_rng(1)
    listed = []
    for g, (count, level) in enumerate(groups):
        drawn = level + 3 * rng.standard_normal((count, 40, 50))
        frames = list(np.clip(np.rint(drawn), 0, 4095 if g else 9999).astype(np.uint16))
        if g:
            frames = [np.full((40, 50), 4095, np.uint16)] * count
        names = tuple(f"{g}-{n}" for n in range(count))
        listed.append((GroupInfo("dark", names, float(g)), frames))
    with pytest.raises(ValueError, match=words):
        fit(plain_statistics(listed, 1, 4095))


def test_frames_of_a_few_pixels_are_refused():
    frames = list(np.arange(45, dtype=np.uint16).reshape(3, 3, 5) ** 2)
    info = GroupInfo("dark", ("a", "b", "c"), 0.0)
    with pytest.raises(
        ValueError, match="has 3 x 2 samples, fewer than noise is known"
    ):
        fit(plain_statistics([(info, frames)], 2, 4095))


def test_rows_that_move_are_none_of_the_noise_of_pixels_beside_masked_ones():
    """One sample in eight does not count, and rows move by as much as pixels do."""
    rng = np.random.default_rng(11)
    shape, sigma, of_rows = (160, 120), 4.0, 4.0
    counted = rng.random(shape) > 1 / 8

    def frame():
        rows = of_rows * rng.standard_normal((shape[0], 1))
        return np.rint(300 + rows + sigma * rng.standard_normal(shape)).astype(
            np.uint16
        )

    frames = [frame() for _ in range(8)]
    info = GroupInfo("dark", tuple(map(str, range(8))), 0.1)
    statistics = frame_statistics(
        [(info, [lambda f=f: f for f in frames])], 1, 4095, excluded=~counted
    )
    found = fit(statistics)
    for name, truth in (("read_noise", sigma**2), ("row_noise", of_rows**2)):
        value, error = found.of(name)
        assert abs(value - truth) < 3 * error, name
        assert error < 0.1 * truth


def test_a_frame_without_a_repeat_has_noise_that_is_not_known():
    """As of a split that one dark is left for: no warning reaches the user."""
    drawn = 200 + 3 * np.random.default_rng(4).standard_normal((48, 64))
    frame = np.rint(drawn).astype(np.uint16)
    alone = plain_statistics([(GroupInfo("dark", ("a",), 0.0), [frame])], 1, 4095)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = Likelihood(alone)
    assert not found.planes[0].measured.any() and not found.is_coarse


@pytest.mark.parametrize("term", ["chi square", "normal"])
def test_the_information_of_a_term_is_the_covariance_of_its_score(term):
    """Over 4000 draws of three numbers that two parameters move: a variance of so many
    is known to 2.2 %, of which 9 % are four."""
    rng, slopes = np.random.default_rng(8), np.array([[1.0, 0.5], [2.0, 0.1], [0.3, 1]])
    expected, freedom = np.array([4.0, 9.0, 2.0]), np.array([8.0, 30.0, 15.0])
    scores = []
    for _ in range(4000):
        found = Evaluation(2)
        if term == "normal":
            rest = np.sqrt(expected) * rng.standard_normal(3)
            found.add_normal(rest, slopes[::-1], expected, slopes, 1.0)
        else:
            measured = expected * rng.chisquare(freedom) / freedom
            found.add_chi_square(measured, expected, slopes, freedom)
        scores.append(found.score)
    np.testing.assert_allclose(np.mean(scores, axis=0), 0, atol=0.1)
    np.testing.assert_allclose(
        np.cov(np.transpose(scores)), found.information, rtol=0.09
    )
