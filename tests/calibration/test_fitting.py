# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import math

import pytest

from calibration.test_table import figure
from cg2raw.calibration.fitting import changed, in_dn, of_all
from cg2raw.calibration.measured import Measured


@pytest.mark.parametrize(("name", "error"), [("black level", 0.4), ("gain", 0.25)])
def test_the_mean_of_sites_is_known_better_where_their_errors_are_their_own(
    name, error
):
    """What moves all levels moves their mean; of others, 0.3 and 0.4 are 0.5 / 2."""
    each = [figure(name, "DN", 2.0, 0.3, 0), figure(name, "DN", 4.0, 0.4, 1)]
    assert of_all(each, name) == Measured(3.0, pytest.approx(error), "DN")
    assert of_all(each, "PRNU") is None


@pytest.mark.parametrize(
    ("name", "unit", "value", "error"),
    [
        ("black level", "DN", 43.0, 0.4),
        ("read noise", "DN", 40.0, 0.4),
        ("dark current", "DN/s", 40.0, 0.4),
        ("gain", "e-/DN", 2.5, 0.025),
        ("PRNU", "1", 10.0, 0.1),
    ],
)
def test_figures_in_steps_of_codes_are_told_in_dn(name, unit, value, error):
    """Of steps of 4 DN from a code of 3 DN on, of 10 +- 0.1."""
    found = in_dn(figure(name, unit, 10.0, 0.1), 4, 3)
    expected = figure(name, unit, value, error)
    assert vars(found) == pytest.approx(vars(expected))
    wider = changed(found, error=math.sqrt(3) * error)  # of twice the error
    assert wider.standard_error == pytest.approx(2 * error)
    assert wider.high - value == pytest.approx(4 * error)
