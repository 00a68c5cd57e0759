# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Levels of flats: what is wrong with them, by pattern over sites and light."""

from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest

import cg2raw
from cg2raw.model.dark_levels import BLACK, DRIFT
from cg2raw.model.fit import fit
from cg2raw.model.flat_levels import (
    FREE,
    MATRIX,
    MATRIX_SHARE,
    WAVES,
    FlatLevels,
    flat_levels,
    levels_set,
)
from cg2raw.model.shapes.dust import NAME as DUST
from model.planted import planted

ERROR, LEAST = 1e-4, 8.0
# R, G, G, B of two lights, 1 at white.
FIRST = np.array([[0.2, 0.5], [0.4, 0.8], [0.4, 0.8], [0.1, 0.3]])
SECOND = np.array([[0.15, 0.6], [0.3, 0.7], [0.3, 0.7], [0.2, 0.5]])


def flats(predicted, levels, rng):
    ratios = (levels / predicted).ravel() + ERROR * rng.standard_normal(levels.size)
    covariance = ERROR**2 * np.eye(levels.size)
    return FlatLevels(ratios, covariance, predicted, np.array(list("RGGB")))


def leaked(x, share=0.02):
    """Both neighbours in a row, by site."""
    return (1 - share) * x + share * x[[1, 0, 3, 2]]


CHANGES = {
    "exposure": lambda x: 1.02 * x,
    "white_balance": lambda x: x * np.array([1.03, 1, 1, 0.98])[:, None],
    "gr_gb_imbalance": lambda x: x * np.array([1, 1.01, 0.995, 1])[:, None],
    "nonlinearity": lambda x: x - 0.02 * x**2,
    "crosstalk": leaked,
}


@pytest.mark.parametrize("name", CHANGES)
def test_each_is_named_alone(name):
    rng, change = np.random.default_rng(5), CHANGES[name]
    found = levels_set(
        flats(FIRST, change(FIRST), rng), flats(SECOND, change(SECOND), rng), LEAST
    )
    assert [one for one, gain in found.gains.items() if gain > LEAST] == [name]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("exposure", [0.02]),
        ("white_balance", [0.03, -0.02]),
        ("gr_gb_imbalance", [0.01, -0.005]),
        ("nonlinearity", [0.02, 0.0]),
        ("crosstalk", [0.02, 0.0]),
    ],
)
def test_values_are_those_that_were_planted(name, values):
    """Within four standard errors; levels are known to a ten-thousandth."""
    rng, change = np.random.default_rng(5), CHANGES[name]
    found, covariance = flats(FIRST, change(FIRST), rng).known([name])
    errors = np.sqrt(np.diagonal(covariance))
    assert (np.abs(found - values) < 4 * errors).all() and errors.max() < 2e-3


@pytest.mark.parametrize("greens", [0.005, -0.005])
def test_no_pixel_takes_light_from_its_neighbours(greens):
    """Greens that differ by the same in lights of one difference of red and blue are
    like light that leaks along rows, and is taken along columns."""
    change = np.array([1, 1 + greens, 1 - greens, 1])[:, None]
    rng = np.random.default_rng(5)
    found = levels_set(*(flats(FIRST, change * FIRST, rng) for _ in "ab"), LEAST)
    assert [*found.gains] == ["gr_gb_imbalance"]
    assert found.alike["gr_gb_imbalance"] == []


def test_levels_as_predicted_name_nothing():
    rng = np.random.default_rng(6)
    two = [flats(x, x, rng) for x in (FIRST, SECOND)]
    assert not levels_set(*two, LEAST).gains


def test_two_that_are_far_from_small():
    """A tenth of exposure and of red: their product is in the pattern of red."""
    rng = np.random.default_rng(7)

    def change(x):
        return 1.1 * x * np.array([1.1, 1, 1, 1])[:, None]

    first = flats(FIRST, change(FIRST), rng)
    found = levels_set(first, flats(SECOND, change(SECOND), rng), LEAST)
    assert set(found.gains) == {"exposure", "white_balance"}
    values = first.fitted(["exposure", "white_balance"])
    assert values == pytest.approx([0.1, 0.1, 0.0], abs=1e-3)


def test_an_exposure_that_may_be_anything_is_not_named():
    rng = np.random.default_rng(8)
    two = [flats(x, 1.02 * x, rng) for x in (FIRST, SECOND)]
    one_light = np.equal.outer(*2 * (np.tile([0, 1], 4),))
    free = [replace(x, covariance=x.covariance + 1e4 * one_light) for x in two]
    assert not levels_set(*free, LEAST).gains


@pytest.mark.parametrize("seed", range(4))
def test_dim_flats_do_not_tell_more_of_bright_ones_than_they_know(seed):
    """A cubic that is fitted to 0.05 to 0.2 of white is nowhere at 0.8: the values that
    are as likely name what bends, and no exposure for it."""
    rng, dim = np.random.default_rng(seed), FIRST / 4
    first, second = (flats(x, x - 0.002 * x**2, rng) for x in (dim, SECOND))
    found = levels_set(first, second, LEAST)
    assert [one for one, gain in found.gains.items() if gain > LEAST] == [
        "nonlinearity"
    ]


def test_values_that_are_drawn():
    """The likelihood of ratios about drawn values is that of both variances."""
    rng = np.random.default_rng(9)
    two, given = flats(SECOND, 1.01 * SECOND, rng), np.array([0.009])
    known = np.array([[4e-6]])
    covariance = two.covariance + known  # an exposure moves all ratios by as much
    rest = two.ratios - 1.009
    wanted = [
        -(rest @ np.linalg.solve(one, rest) + np.linalg.slogdet(one)[1]) / 2
        for one in (two.covariance, covariance)
    ]
    drawn = two.value(["exposure"], given, known) - two.value(["exposure"], given)
    assert drawn == pytest.approx(wanted[1] - wanted[0], rel=1e-4)


def levels_of(found, predicted, white=1.0, **more):
    """Return flat_levels of light that is known, and nothing else that may move
    levels, but for @more."""
    nothing = {"light": 0.0, "nuisances": frozenset(), "named": (), "doubted": ()}
    nothing |= {"shaded": np.ones(4), "greys": np.ones_like(predicted)}
    nothing |= {"unseen_dust": 0.001}
    return flat_levels(found, predicted, "RGGB", white=white, **(nothing | more))


def test_waves_down_the_rows_move_the_mean():
    """By as much as another of their coefficients, in all sites of one light alike."""
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    predicted = np.where(found.likelihood.planes[0].is_flat, 1.0, np.nan)
    covariances = []
    for variance in (0.0, 0.02):
        theta = found.theta.copy()
        theta[[found.parameters.of(name) for name in WAVES]] = 0.0, variance
        levels = levels_of(replace(found, theta=theta), np.tile(predicted, (4, 1)))
        covariances.append(levels.covariance)
    one_light = np.equal.outer(*2 * (np.tile([0, 1], 4),))
    wanted = 0.02 / (32 * 40) / 6 * one_light  # samples of a plane, frames
    assert covariances[1] - covariances[0] == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("nuisance", "alike", "names"),
    [
        ("exposure", "AAAA", set(CHANGES)),
        ("white_balance", "RGGB", {"gr_gb_imbalance"}),
    ],
)
def test_a_nuisance_may_be_anything_in_each_light(nuisance, alike, names):
    """That all sites share, or those of each colour, which then show no colour."""
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    is_flat = found.likelihood.planes[0].is_flat
    predicted = np.tile(np.where(is_flat, 1.0, np.nan), (4, 1))
    free, known = (
        levels_of(found, predicted, nuisances=frozenset(some))
        for some in ([nuisance], [])
    )
    shared = np.equal.outer(list(alike), list(alike))
    expected = FREE * np.kron(shared, np.eye(2))
    assert free.covariance - known.covariance == pytest.approx(expected)
    assert (set(free.names), set(known.names)) == (names, set(CHANGES))
    no_filters = replace(known, letters=np.array(["X"]))
    assert no_filters.names == ["exposure", "nonlinearity"]


def test_a_colour_matrix_mixes_what_flats_are_not_grey_by():
    """By a share of what another colour differs by; greys stay."""
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    is_flat = found.likelihood.planes[0].is_flat
    lights = np.array([[1.1, 0.9], [1.0, 1.0], [1.0, 1.0], [1.0, 1.2]])
    predicted, greys = np.full((2, 4, len(is_flat)), np.nan)
    greys[:, is_flat] = np.array([0.5, 1.0, 1.0, 0.7])[:, None]
    predicted[:, is_flat] = greys[:, is_flat] * lights
    covariances = [
        levels_of(found, predicted, doubted=doubted, greys=greys).covariance
        for doubted in ([], [MATRIX])
    ]
    expected = np.zeros_like(covariances[0])
    for sites, others in product(([0], [1, 2], [3]), ([0], [1], [3])):
        ratios = np.zeros_like(lights)
        ratios[sites] = MATRIX_SHARE * (lights[others] / lights[sites] - 1)
        expected += np.outer(ratios, ratios)
    assert covariances[1] - covariances[0] == pytest.approx(expected)


def test_a_black_level_that_is_doubted_may_be_off_by_as_much_as_white():
    """Of each site, in all its flats alike."""
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    is_flat = found.likelihood.planes[0].is_flat
    predicted = np.tile(np.where(is_flat, 1.0, np.nan), (4, 1))
    known, doubted = (
        levels_of(found, predicted, white=100.0, doubted=one).covariance
        for one in ([], [BLACK])
    )
    light = np.concatenate([p.light[is_flat] for p in found.likelihood.planes])
    one_site = np.kron(np.eye(4), np.ones((2, 2)))
    expected = one_site * 100.0**2 / np.outer(light, light)
    assert doubted - known == pytest.approx(expected)


def test_dust_that_is_doubted_takes_as_much_of_all_light():
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    is_flat = found.likelihood.planes[0].is_flat
    predicted = np.tile(np.where(is_flat, 1.0, np.nan), (4, 1))
    known, doubted = (
        levels_of(found, predicted, doubted=one).covariance for one in ([], [DUST])
    )
    assert doubted - known == pytest.approx(np.full((8, 8), 1e-6))


def test_a_drift_that_is_doubted_moves_all_sites_of_a_frame_by_the_read_noise():
    found = fit(planted(3, side=2, shape=(64, 80)).statistics)
    planes = found.likelihood.planes
    is_flat = planes[0].is_flat
    predicted = np.tile(np.where(is_flat, 1.0, np.nan), (4, 1))
    known, doubted = (
        levels_of(found, predicted, doubted=one).covariance for one in ([], [DRIFT])
    )
    light = np.concatenate([p.light[is_flat] for p in planes])
    read = found.theta[found.parameters.each("read_noise")].mean()
    one_frame = np.kron(np.ones((4, 4)), np.diag(read / planes[0].frames[is_flat]))
    assert doubted - known == pytest.approx(one_frame / np.outer(light, light))


def test_cameras_share_colours_as_bundled_sensors_do():
    """The root mean square of 306 pairs, under D65."""
    colors = np.array([[*np.eye(3), np.ones(3)]], np.float32)
    matrices = []
    for name in cg2raw.installed_profiles():
        sensor = cg2raw.Sensor(name)
        camera = sensor.to_camera(colors, illuminant="D65", highlights=False)[0]
        matrices.append((camera[:3] / camera[3]).T.astype(float))
    shares = [
        (one @ np.linalg.inv(other))[~np.eye(3, dtype=bool)]
        for one, other in permutations(matrices, 2)
    ]
    assert len(shares) == 306
    assert np.sqrt(np.mean(np.square(shares))) == pytest.approx(MATRIX_SHARE, abs=0.01)
