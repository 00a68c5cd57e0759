# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import numpy as np
import pytest
from scipy import special

from cg2raw.normal import CI95, MAD, TUKEY_LAMBDA, robust_deviation


def test_published_numbers():
    assert CI95 == pytest.approx(special.ndtri(0.975), abs=1e-6)
    assert MAD == pytest.approx(1 / special.ndtri(0.75), abs=1e-4)
    share = np.linspace(0.01, 0.99, 99)
    normal = special.ndtri(share)
    of_tukey = (share**TUKEY_LAMBDA - (1 - share) ** TUKEY_LAMBDA) / TUKEY_LAMBDA
    slope = (of_tukey @ normal) / (normal @ normal)
    assert np.abs(of_tukey / slope - normal).max() < 0.005


def test_what_is_far_off_moves_a_deviation_by_little():
    values = np.random.default_rng(1).normal(3, 2, 200_000)
    assert robust_deviation(values) == pytest.approx(2, rel=0.01)
    values[::10] = 1e6
    # Half of all lie as near as five ninths of those that are normal.
    most = 2 * special.ndtri(0.5 + 5 / 18) / special.ndtri(0.75)
    assert robust_deviation(values, 3.0) == pytest.approx(most, rel=0.01)


def test_it_is_about_the_median_or_a_given_number():
    values = np.array([1.0, 2.0, 3.0, 4.0, 50.0])
    assert robust_deviation(values) == MAD
    assert robust_deviation(values, 0.0) == 3 * MAD
