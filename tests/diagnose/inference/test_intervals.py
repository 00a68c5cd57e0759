# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Errors of values whose likelihood has its top elsewhere, or none."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.inference.intervals import _errors_by_likelihood
from cg2raw.diagnose.likelihood.model import Term
from diagnose.planted import BY_NAME

TAILS = BY_NAME["heavy_tailed_noise"]  # a share and a ratio of variances
# Of the logarithms of both: a wide share of a narrow ratio is like the reverse.
PRECISION = np.array([[2400.0, 2500.0], [2500.0, 3100.0]])
ERRORS = np.sqrt(np.diag(np.linalg.inv(PRECISION)))


def errors_at(values, height):
    """Return the errors of tails at values, by a likelihood of any values."""
    model = SimpleNamespace(with_values=lambda name, values: values)
    likelihood = SimpleNamespace(total=height)
    return _errors_by_likelihood(model, Term(TAILS, np.array(values)), likelihood)


def of_logs(top):
    def height(values):
        away = np.log(np.asarray(values) / top)
        return -0.5 * away @ PRECISION @ away

    return height


@pytest.mark.parametrize("beside", [(1.0, 1.0), (1.05, 1.05), (1.08, 1.08)])
def test_beside_the_top_errors_are_those_of_logarithms(beside):
    """There a likelihood may bend upwards in the values themselves, and they were as
    unsure as they are large."""
    top = np.array([0.0066, 25.0])
    found = errors_at(top * beside, of_logs(top))
    np.testing.assert_allclose(found, ERRORS * top, rtol=0.25)


def test_values_without_a_top_may_be_nothing():
    found = errors_at([0.0066, 25.0], lambda values: 1e3 * values[0] ** 2)
    assert found == pytest.approx([0.0066, 25.0])
