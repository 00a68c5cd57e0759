# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Errors of values whose likelihood has its top elsewhere, or none."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.intervals import SmoothValues, _errors_by_likelihood
from cg2raw.diagnose.inference.robust_errors import Covariances
from cg2raw.diagnose.likelihood.model import Model, Term
from diagnose.planted import (
    BY_NAME,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

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


def test_squares_of_distances_of_nothing_are_of_chi_square():
    """Four offsets that are fitted to frames without any: 4, and 8 is the variance."""
    sensor = sensor_of()
    frames = frames_of(sensor, captures_of(["dark", "flat"], shape=(32, 48)))
    found = []
    for seed in range(60):
        likelihood = on(drawn(frames, Model(sensor), seed))
        model = fit(model_of(sensor, black_level=[0.0]), likelihood)
        used = BY_NAME["black_level"].used
        smooth = SmoothValues.of(model, likelihood)
        found.append(smooth.square_of_distance("black_level", used))
    assert np.mean(found) == pytest.approx(4, abs=3 * np.sqrt(8 / 60))
    assert np.mean(np.greater(found, 9.49)) < 0.15  # the upper 5 %


@pytest.mark.parametrize(("second", "square"), [(1.0, 2 / 1.99), (-1.0, 200.0)])
def test_two_values_may_be_none_each_and_both_cannot(second, square):
    """Of which frames tell the difference, and hardly the sum."""
    name = "gr_gb_imbalance"
    alike = np.array([[1.0, 0.99], [0.99, 1.0]])
    told = Covariances(alike, alike, 100.0)
    model = model_of(sensor_of(), **{name: [1.0, second]})
    smooth = SmoothValues(model, [(name, 0), (name, 1)], told)
    found = smooth.square_of_distance(name, BY_NAME[name].used)
    assert found == pytest.approx(square)
