# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Figures of planted sensors; of a real one: tests/calibration/test_ccd.py."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import binom, chi2, t

from cg2raw.model.figures import Figure, _light, _root, figures_of
from cg2raw.model.fit import fit
from cg2raw.model.structure import structure_of
from cg2raw.normal import CI95
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics
from model.coverage import misses
from model.planted import planted
from tiers import first_fast


@pytest.mark.parametrize(("side", "sets"), [(1, 8), (2, 3)])
def test_a_planted_sensor_is_found(side, sets):
    """All values within 5 standard errors, but for the drift, which few frames tell;
    and as many intervals hold as do of 95 % ones in all but 1 of 10,000 draws."""
    found = misses(range(sets), side=side, shape=(64, 80))
    assert len(found) == (14 if side == 1 else 22)
    inside = np.concatenate([[one[0] for one in rows] for rows in found.values()])
    assert inside.sum() >= binom.ppf(1e-4, len(inside), 0.95)
    for name, rows in found.items():
        assert (
            np.abs([off for _, off in rows if name[-5:] != "drift"]).max(initial=0) < 5
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", [{}, *({"low": True, "black": b, "noise": 0.25} for b in (64, 0))]
)
def test_intervals_hold_in_95_of_100_sets(options):
    """Of 400 sets 93 to 97 %, and what chance makes of 95 % in one of 100 figures. That
    of the dark current is wide: Student's of few frames, and widened by what levels
    miss their line by chance, but never narrowed."""
    for name, rows in misses(range(400), **options).items():
        share = np.mean([inside for inside, _ in rows])
        most = 0.995 if name == "dark current" else 0.97 + 0.015
        assert 0.93 - 0.015 <= share <= most, (name, share)


def test_darks_that_are_mostly_zero_show_nothing():
    found = misses(range(2), low=True, black=0, noise=0.25, shape=(64, 80))
    assert set(found) == {"gain 0", "PRNU", "shading"}


def test_shading_is_of_groups_that_are_not_cut():
    """Darks of noise of 0.5 DN without a pedestal: their shape is recorded in part."""
    found = misses([23], low=True, black=0, noise=0.5)
    ((is_inside, _),) = found["shading"]
    assert is_inside


@pytest.mark.parametrize("noise", first_fast([0.25, 0.4], 1))
def test_read_noise_of_a_fraction_of_a_code(noise):
    """As above, of noise that codes hide: off by less than a standard error in the
    mean."""
    sets = 4
    found = misses(range(sets), low=True, black=64, noise=noise, shape=(90, 120))
    inside, off = np.array(found["read noise 0"]).T
    assert inside.sum() >= binom.ppf(1e-3, sets, 0.95) and abs(off.mean()) < 1
    for name in ("correlation, next in row", "row noise", "column noise"):
        assert max(abs(off) for _, off in found[name]) < 4


@pytest.mark.parametrize(
    ("square", "value", "error", "low", "high"),
    [
        (9.0, 3.0, 0.2 / 3, 9 - 0.4 * CI95, 9 + 0.4 * CI95),  # by the slope of a root
        (0.0, 0.0, None, 0.0, 0.4 * CI95),  # which has none at 0
        (-0.2, 0.0, None, 0.0, 0.4 * CI95 - 0.2),
        (-2.0, 0.0, np.nan, 0.0, 0.0),  # no variance at all
    ],
)
def test_a_deviation_is_the_root_of_a_variance_known_to_0_4(
    square, value, error, low, high
):
    """Its ends are those of the variance; its error is at most half of that."""
    found = _root("row noise", "DN", square, 0.4, site=2)
    ends = np.sqrt([low, high])
    error = (ends[1] - ends[0]) / 2 / CI95 if error is None else error
    assert (found.low, found.high) == pytest.approx(tuple(ends))
    assert found.standard_error == pytest.approx(error, nan_ok=True)
    assert (found.name, found.unit, found.value, found.site) == (
        "row noise",
        "DN",
        value,
        2,
    )


@pytest.mark.parametrize("error", [0.1, 0.4])
def test_electrons_per_dn_are_one_over_the_gain(error):
    """Of 0.5 DN per electron; where that may be 0, there is no upper end."""
    values = {"gain": (0.5, error), "prnu": (1e-4, 1e-5)}
    parameters = SimpleNamespace(sites=1)
    fitted = SimpleNamespace(
        of=lambda name, site=0: values[name], parameters=parameters
    )
    gain = next(_light(fitted))
    assert (gain.value, gain.unit, gain.site) == (2.0, "e-/DN", 0)
    assert gain.standard_error == pytest.approx(2.0 * error / 0.5)
    assert gain.low == pytest.approx(1 / (0.5 + CI95 * error))
    most = 1 / (0.5 - CI95 * error) if error < 0.2 else np.inf
    assert gain.high == pytest.approx(most)


@pytest.mark.parametrize(("least", "low"), [(0.0, 0.4), (0.5, 0.5)])
def test_an_interval_ends_at_the_least_that_a_value_may_be(least, low):
    figure = Figure.normal("x", "DN", 1.0, 0.6 / CI95, least)
    assert (figure.low, figure.high) == (pytest.approx(low), pytest.approx(1.6))


def by_name(*groups):
    """Return the figures of groups, (GroupInfo, frames), by name."""
    readers = [(info, [lambda f=f: f for f in frames]) for info, frames in groups]
    statistics = frame_statistics(readers, 1, 65535)
    return {one.name: one for one in figures_of(statistics, fit(statistics))}


def figures_of_darks(levels, noise, splits=("training",)):
    """Return the figures, by name, of darks of levels, DN, an equal number per split;
    and the means of the frames."""
    rng, many = np.random.default_rng(3), len(levels) // len(splits)
    frames = [
        np.rint(level + noise * rng.standard_normal((60, 70))).astype(np.uint16)
        for level in levels
    ]
    groups = [
        (
            GroupInfo("dark", tuple("abcdef"[:many]), 0.1, split=split),
            frames[many * n : many * (n + 1)],
        )
        for n, split in enumerate(splits)
    ]
    return by_name(*groups), np.array([frame.mean() for frame in frames])


def test_darks_of_two_splits_repeat_each_other():
    """Their levels scatter about one mean: sd of all eight, not about two means."""
    levels = [200, 201, 202, 203, 210, 211, 212, 213]
    figures, _ = figures_of_darks(levels, 3.0, ("training", "validation"))
    drift = figures["black level drift"].value
    assert drift == pytest.approx(np.std(levels, ddof=1), rel=0.02)


def test_intervals_of_levels_are_those_of_few_frames():
    """By quantiles of five freedoms: Student's of the mean, chi-square of the variance,
    less what a noise of 60 DN makes of it in 4200 pixels."""
    figures, means = figures_of_darks([998, 999, 1001, 1002, 1003, 1006], 60.0)
    level, drift = figures["black level"], figures["black level drift"]
    variance, noise = means.var(ddof=1), 60**2 / 4200
    assert level.value == pytest.approx(means.mean(), abs=0.05)
    half = t.ppf(0.975, 5) * np.sqrt(variance / 6)
    assert level.high - level.value == pytest.approx(half, rel=0.02)
    squares = variance * 5 / chi2.ppf([0.975, 0.025], 5) - noise
    assert np.square([drift.low, drift.high]) == pytest.approx(squares, rel=0.02)
    assert drift.value**2 == pytest.approx(variance - noise, rel=0.02)
    assert drift.freedom == 5


DARKS = GroupInfo("dark", tuple("abcdef"), 0.1)


def neighbours(axis, noise, of_rows=0.0):
    """Return darks whose noise, DN, has 0.3 of the one before, and noise of rows."""
    rng = np.random.default_rng(8)
    own = rng.standard_normal((6, 61, 71))
    own = (own + 0.3 * np.roll(own, 1, axis + 1))[:, 1:, 1:]
    rows = of_rows * rng.standard_normal((6, 60, 1))
    return np.rint(500 + noise * own + rows).astype(np.uint16)


@pytest.mark.parametrize(
    ("axis", "there", "other"), [(0, "column", "row"), (1, "row", "column")]
)
def test_noise_of_neighbours_is_correlated_along_its_own_lines(axis, there, other):
    """Of 0.3 of the one before: r = 0.3 / (1 + 0.3^2), of three pairs of frames."""
    found = by_name((DARKS, neighbours(axis, 9.0)))
    for line, r in ((there, 0.3 / 1.09), (other, 0.0)):
        figure = found[f"correlation, next in {line}"]
        assert figure.standard_error == pytest.approx(1 / (3 * 4200) ** 0.5, rel=0.2)
        assert figure.value == pytest.approx(r, abs=4 * figure.standard_error)


def test_a_frame_on_its_side_has_its_correlations_along_the_other_lines():
    """Even of noise that codes hide, of which lines' noise shows a part."""
    frames = neighbours(1, 0.25, of_rows=0.5)
    plain, turned = (by_name((DARKS, f)) for f in (frames, frames.swapaxes(1, 2)))
    for line, other in (("row", "column"), ("column", "row")):
        one, same = (
            found[f"correlation, next in {name}"]
            for found, name in ((plain, line), (turned, other))
        )
        assert one.value == pytest.approx(same.value, rel=1e-3, abs=1e-3)


def test_shading_is_known_no_better_than_the_light_of_its_flats():
    """Of flats of one light: relative to that, which their level's drift moves."""
    made = planted(4)
    statistics = made._replace(groups=made.groups[:-1]).statistics
    found = fit(statistics)
    place = found.parameters.of("black_level_drift")
    errors = []
    for drift in (0.0, 100.0):
        found.theta[place] = drift
        square, error = structure_of(found, "light")
        errors.append(error)
    (plane,) = found.likelihood.planes
    by_level = 100.0 / statistics.frames[-1] / plane.light[-1] ** 2
    grown = errors[1] ** 2 - errors[0] ** 2
    assert grown == pytest.approx(4 * square**2 * by_level, rel=0.02)
    assert grown > errors[0] ** 2
