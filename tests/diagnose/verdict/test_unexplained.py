# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is left of held-out frames, by the laws of the tests that say so."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2, norm

from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.verdict import unexplained
from cg2raw.statistics.constant import PARTS, PIXEL, GroupInfo
from cg2raw.statistics.patterns import Spots


def fit_of(frames, squares=1.0, freedom=100.0):
    """Return what a test asks of a fit: darks of 60 s whose pixels' squares are so many
    times what is expected."""
    ones = np.ones((1, len(PARTS)))
    plane = SimpleNamespace(
        frames=np.array([frames]),
        scatter=squares * ones,
        freedom=np.where(np.arange(len(PARTS)) == PIXEL, freedom, 0.0) * ones,
        records=lambda theta: (),
        temporal=lambda theta: (ones, None),
    )
    groups = [GroupInfo("dark", (), 60.0)]
    means = SimpleNamespace(
        covariances=lambda *_: [], statistics=SimpleNamespace(groups=groups)
    )
    return SimpleNamespace(
        likelihood=SimpleNamespace(planes=[plane], means=means), theta=None
    )


@pytest.mark.parametrize(
    ("squares", "words"), [(1.3, "30.0% more"), (0.8, "20.0% less")]
)
def test_a_part_is_tested_by_its_chi_square_and_the_fit_s_own_error(squares, words):
    """Of 4 frames by the fit of 12, whose mean is known a third as well: the variance
    of a ratio is 4/3 of what it would be."""
    [test] = unexplained.tests_of(fit_of(4, squares), fit_of(12), 1000)
    law = chi2(0.75 * 100)
    p_value = 2 * min(law.sf(75 * squares), law.cdf(75 * squares))
    assert test.p_value == pytest.approx(p_value)
    assert test.statistic == pytest.approx(squares - 1)
    nats = 100 / 2 * (squares - 1 - np.log(squares))
    assert test.nats_per_pixel == pytest.approx(nats / 1000)
    assert test.name == "noise of single pixels, darks of 60 s"
    assert test.where.startswith(f"{words} variance than predicted from frame to frame")


@pytest.mark.parametrize(
    ("p_value", "nats", "gained", "is_left"),
    [
        (4e-4, 3e-4, 0.0, True),  # two tests share a chance of 1e-3
        (6e-4, 3e-4, 0.0, False),
        (4e-4, 1e-4, 0.0, False),  # a trace
        (4e-4, 3e-4, 0.4, False),  # less than a thousandth of what was closed
        (0.9e-4, 2e-3, 10.0, True),  # nobody calls that a trace
        (1.1e-4, 2e-3, 10.0, False),
    ],
)
def test_what_is_left_is_neither_chance_nor_a_trace(p_value, nats, gained, is_left):
    one, other = (ResidualTest("", 0.0, p, nats, "") for p in (p_value, 1.0))
    assert unexplained.left_over([one, other], gained) == ([one] if is_left else [])


@pytest.mark.parametrize(
    ("chi_square", "freedom", "gained", "word"),
    [
        (1.021, 1e6, 0.0, "larger"),
        (0.979, 1e6, 0.0, "smaller"),
        (1.019, 1e6, 0.0, None),
        (1.05, 2e4, 0.0, "larger"),  # of a standard error of 1 %
        (1.039, 2e4, 0.0, None),
        (1.05, 1e6, 1.0, None),  # 6e-4 nats are left of 1
    ],
)
def test_chi_square_is_near_1_within_2_percent_and_4_errors(
    chi_square, freedom, gained, word
):
    found = unexplained.chi_square_test(chi_square, freedom, gained)
    assert [one.where.split()[3] for one in found] == ([word] if word else [])
    for one in found:
        errors = abs(chi_square - 1) / np.sqrt(2 / freedom)
        assert one.p_value == pytest.approx(2 * norm.sf(errors))
        # By its first terms: x^2 / 4 of nats that a variance off by x has.
        assert one.nats_per_pixel == pytest.approx((chi_square - 1) ** 2 / 4, rel=0.05)


def test_structure_that_no_effect_has_is_as_likely_as_its_nats_say():
    gains = {"column_noise": 20.0, "rows of light": -3.0}
    one, none = unexplained.unnamed_tests(gains, 1000)
    assert (one.p_value, one.nats_per_pixel) == pytest.approx((np.exp(-20), 0.02))
    assert (none.p_value, none.nats_per_pixel) == (1, 0)
    assert one.where == "columns differ, anew in every frame"


def test_spots_that_are_no_dust_are_told_where_they_are():
    places = np.array([[10.2, 20.0, 3.0], [70.0, 30.4, 9.0]])
    gains = {"spots of light": 40.0}
    [one] = unexplained.unnamed_tests(gains, 1000, Spots(places, 50))
    assert one.where == (
        "round spots are darker, the same in all flats, and not of the shape of dust; "
        "the largest of 2 is at row 70, column 30"
    )
