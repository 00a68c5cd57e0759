# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A search that ends at its bound gives a limit, and no number with an error."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2, norm, truncnorm

from calibration.planted import RANGE, SHAPE, sensor_of
from cg2raw import _core
from cg2raw.calibration import report
from cg2raw.calibration.calibrate import check_groups
from cg2raw.calibration.calibration import (
    Calibration,
    bounds_passed,
    effects_found,
)
from cg2raw.calibration.darks import MOST_HOT, DarkCurrent, dark_spread
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.flats import PhotonTransfer
from cg2raw.calibration.measured import CUT, LEFT, Measured
from cg2raw.calibration.sites import Sites
from cg2raw.calibration.structure import glow
from cg2raw.calibration.table import dark_lines, dynamic_range
from cg2raw.model.figures import Figure
from cg2raw.statistics.constant import RATE_EDGES, DarkRates

NOISE = 0.1  # DN/s
KNOWN = {effect["name"]: effect for effect in _core.effects()}


def rates(share, mean, seed=1):
    """Return rates of 40,000 pixels above their median: hot ones of that share."""
    rng = np.random.default_rng(seed)
    found = (rng.random(40_000) < share) * rng.exponential(mean, 40_000)
    found += rng.normal(0, NOISE, 40_000)
    return found - np.median(found)


def law_of(rates):
    """Return the law of rates that were measured with that noise."""
    counts = np.histogram(np.clip(rates / NOISE, -9e4, 9e4), RATE_EDGES)[0]
    return dark_spread(DarkRates("", counts, NOISE, 0.0), 0.0)


def test_a_planted_law_is_found_in_its_units():
    """Within 3.5 standard errors, DN/s; all is counted from the mean without hot."""
    rng = np.random.default_rng(4)
    even = 0.5 * np.exp(0.8 * rng.standard_normal(40_000))
    hot = (rng.random(40_000) < 0.01) * rng.exponential(10.0, 40_000)
    law = law_of(even - even.mean() + hot + rng.normal(0, NOISE, 40_000))
    for one, truth in (
        (law.rate, 0.5),
        (law.log_sigma, 0.8),
        (law.fraction, 0.01),
        (law.hot_rate, 10.0),
        (law.median, 0.5 - 0.5 * np.exp(0.32)),
    ):
        assert one.value == pytest.approx(truth, abs=3.5 * one.standard_error)
        assert one.standard_error < 0.15 * abs(truth)
    assert law.has_hot and law.is_uneven
    assert law.hot_words == law.uneven_words == ""


def test_no_hot_pixel_is_a_limit():
    """No pixel of N: at 95 % fewer than 3 / N, or a few times that of what a normal
    law hides. An unevenness of the others is not found either."""
    law = law_of(rates(0.0, 1.0))
    assert not law.has_hot and not law.is_uneven
    assert 3 / 40_000 < law.most_hot < 10 / 40_000
    assert law.hot_words.startswith("not found; below 0.0")


def test_an_unevenness_is_no_hot_pixels():
    """Of a law whose largest rates are 20 times the noise."""
    even = 0.5 * np.exp(0.5 * np.random.default_rng(6).standard_normal(40_000))
    law = law_of(even - even.mean() + rates(0.0, 1.0))
    assert law.is_uneven and not law.has_hot


def test_quantiles_of_mere_noise_are_those_of_a_normal():
    """Of 40,000 pixels, 4 are above the last: it is known to a tenth."""
    quantiles = law_of(rates(0.0, 1.0)).quantiles
    for share, value in quantiles.items():
        assert value == pytest.approx(NOISE * norm.ppf(share), rel=0.1)
    assert len(quantiles) == 4


def test_the_limit_of_hot_pixels_grows_with_what_is_seen():
    """Of 12 hot pixels there may be 20: 12 and two of their standard deviations."""
    rng = np.random.default_rng(7)
    found = rates(0.0, 1.0)
    found[:12] += 4 + rng.exponential(20 * NOISE, 12)
    law = law_of(found)
    assert law.has_hot and law.hot_words == "" and law.spread_nats < 3
    assert 12 / 40_000 < law.most_hot < 30 / 40_000


def test_more_hot_pixels_than_are_searched_for():
    law = law_of(rates(0.35, 30.0))
    assert law.has_too_many_hot and not law.has_hot and not law.is_uneven
    assert law.hot_words == f"more than {MOST_HOT:.0%}"
    rows = {name: value for name, value, _ in dark_lines(found_with(spread=law))}
    for name in ("hot pixels", "hot pixels, mean rate", "nonuniformity, rate"):
        assert rows[name] is None
    found = effects_found(found_with(spread=law), False)
    assert "hot_pixels" not in found  # the profile's own stays


def test_others_as_uneven_as_hot_pixels_are_have_no_law():
    """A third is hot, and what is measured of most is about the mean of all."""
    rng = np.random.default_rng(7)
    hot = (rng.random(40_000) < 0.35) * rng.exponential(30.0, 40_000)
    found = hot + rng.normal(0, 2.2, 40_000)
    law = law_of((found - found.mean()) * NOISE / 2.2)
    assert law.has_too_many_hot and not law.has_hot and not law.is_uneven
    assert law.hot_words == "not told from the others, which are as uneven"
    assert law.uneven_words == "not shown among so many hot"


def found_with(**fields):
    """Return measurements of one site with some fields, and a dark current."""
    line = DarkCurrent(((None, Measured(1.0, 0.1, "DN/s")),), None, ())
    known = {"sensor": sensor_of(), "shape": SHAPE, "iso": None, "frames": (4, 0)}
    known |= {"sites": Sites(("",)), "dark": line}
    return Calibration(**known | fields)


def test_set_points_have_marks_of_their_own(monkeypatch):
    drawn = []
    monkeypatch.setattr(report, "lines", lambda _, marks, *more: drawn.extend(marks))
    rates = tuple((t, Measured(1.0, 0.1, "DN/s")) for t in (-10.0, 0.0, 10.0))
    points = tuple((60.0, 60.0 + n, n) for n in range(3))
    report.dark_current(DarkCurrent(rates, None, points))
    dots = [mark for mark in drawn if mark.style == "dots"]
    assert [mark.label for mark in dots] == ["-10.0 C", "0.0 C", "10.0 C"]
    assert len({mark.shape for mark in dots}) == 3


def test_frames_that_are_all_saturated_are_said_by_the_first():
    items = [
        SimpleNamespace(saturated=s, frame=SimpleNamespace(name=n))
        for n, s in (("a", 1.0), ("b", 0.99))
    ]
    group = SimpleNamespace(kind="flat", frames=items)
    with pytest.raises(ValueError, match="^a: 100% of its pixels are saturated"):
        check_groups([group])


def test_a_glow_as_wide_as_the_field_is_a_limit():
    """A slope over the field is like any wide glow."""
    rng = np.random.default_rng(3)
    slope = np.linspace(0, 2, 320)[None] + rng.normal(0, 0.05, (256, 320))
    shine = glow(slope.astype(np.float32))
    assert shine.stands_out and not shine.is_measured
    rows = {name: more for name, *more in dark_lines(found_with(glow=shine))}
    value, words = rows["amplifier glow"]
    assert value is None and "wider than 1 half diagonals" in words


def test_what_a_cut_leaves_of_a_variance_is_that_of_a_truncated_normal():
    assert LEFT == pytest.approx(truncnorm.var(-CUT, CUT), rel=1e-9)


def test_the_dynamic_range_is_saturation_over_the_noise_of_a_dark():
    """EMVA 1288: 20 log10 of both, here each known to a hundredth."""
    noise = Figure("temporal dark noise", "DN", 5.0, 0.05, 4.9, 5.1)
    full = PhotonTransfer(saturation=Measured(10_000.0, 100.0, "DN"))
    found = dynamic_range(found_with(fit=Fitted([noise]), transfer=full))
    assert found.value == pytest.approx(20 * np.log10(2000))
    assert found.standard_error == pytest.approx(20 / np.log(10) * 0.01 * 2**0.5)


@pytest.mark.parametrize(
    ("value", "error", "passed"),
    [(0.01, 0.001, 0), (0.2, 0.001, 1), (0.22, 0.001, 1), (0.2001, 0.001, 0)],
)
def test_an_effect_at_a_bound_of_the_registry_is_not_written(value, error, passed):
    """PRNU is at most 0.2; a value that its own error takes beyond is cut."""
    words = bounds_passed({"sigma": Measured(value, error, "1")}, KNOWN["prnu"])
    assert len(words) == passed
    assert all(f"sigma is {value:g}; must be between" in one for one in words)


def test_a_pattern_below_a_hundredth_of_the_noise_is_in_the_profile():
    """The fit knows its noise better than any floor: 0.32 +- 0.014 DN beside a noise of
    6.7 DN in 4 frames."""
    low, high = 0.32 - 1.96 * 0.014, 0.32 + 1.96 * 0.014
    figure = Figure("DSNU", "DN", 0.32, 0.014, low, high)
    found = effects_found(found_with(fit=Fitted([figure])), False)["dsnu"]["sigma"]
    assert found.value == pytest.approx(0.32 / RANGE)


@pytest.mark.parametrize("shape", [(100, 90), (193, 40), (1000, 400)])
def test_a_map_has_few_cells_of_equal_means(shape, monkeypatch):
    drawn = []
    monkeypatch.setattr(report, "map_image", lambda cells, *_: drawn.append(cells))
    values = np.add.outer(np.arange(shape[0]), np.arange(shape[1])).astype(float)
    report.drawn_map("map", values, "DN")
    side = -(-max(shape) // 192)
    assert drawn[0].shape == (shape[0] // side, shape[1] // side)
    assert drawn[0][0, 0] == side - 1  # the mean of the first cell
    assert drawn[0][1, 1] - drawn[0][0, 0] == 2 * side


@pytest.mark.parametrize("freedom", [1.0, 4.0, 30.0])
def test_a_drift_that_chance_makes_is_none(freedom):
    """Chi-square of so many freedoms is as large in 1 of 740."""
    floor, largest = 4.0, chi2(freedom).isf(0.00135) / freedom

    def drift_of(total):
        high = total * freedom / chi2(freedom).ppf(0.025) - floor
        square, end = max(total - floor, 0.0), float(np.sqrt(high))
        drift = Figure(
            "black level drift", "DN", square**0.5, 1.0, 0.0, end, freedom=freedom
        )
        answers = effects_found(found_with(fit=Fitted((drift,))), False)
        return answers["black_level_drift"]

    assert drift_of(floor * largest * 0.99) is None
    assert drift_of(floor * largest * 1.01) is not None
