# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import math

import pytest

from calibration.test_bounds import found_with
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.table import rows_of, told
from cg2raw.model.figures import Figure


@pytest.mark.parametrize(
    ("value", "error", "words"),
    [
        (12.9341, 0.0512, "12.934 +- 0.051 DN"),
        (2.0, 1.0, "2.0 +- 1.0 DN"),
        (1234.6, 25.4, "1235 +- 25 DN"),
        (123456.0, 2540.0, "123456 +- 2540 DN"),
        (1.234e-4, 2.1e-6, "0.0001234 +- 0.0000021 DN"),
        (3.5, 0.0, "3.5 DN"),
        (3.5, math.nan, "3.5 DN"),
    ],
)
def test_a_number_has_the_digits_that_its_error_leaves(value, error, words):
    assert told(Measured(value, error, "DN")) == words


def figure(name, unit, value, error, site=None):
    """Return a figure with an interval of two errors."""
    return Figure(name, unit, value, error, value - 2 * error, value + 2 * error, site)


def test_rows_have_electrons_by_the_gain_and_intervals():
    """Errors of a number and of the gain, of a hundredth each, add in squares."""
    figures = [
        figure("gain", "e-/DN", 2.0, 0.02),
        figure("temporal dark noise", "DN", 5.0, 0.05),
        figure("black level", "DN", 256.0, 0.1),
        figure("PRNU", "1", 0.01, 0.001),
    ]
    rows = {row.name: row for row in rows_of(found_with(fit=Fitted(figures)))}
    noise = rows["temporal dark noise"]
    assert noise.electrons.standard_error == pytest.approx(10 * math.hypot(0.01, 0.01))
    assert (noise.electrons.value, noise.electrons.unit) == (10.0, "e-")
    assert rows["dark current, median"].electrons.unit == "e-/s"
    assert rows["black level"].electrons is None and rows["PRNU"].electrons is None
    assert (noise.more, rows["PRNU"].more) == ("95 %: 4.9 to 5.1", "95 %: 0.8 to 1.2")
    assert rows["PRNU"].value == Measured(pytest.approx(1.0), pytest.approx(0.1), "%")
