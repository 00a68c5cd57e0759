# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import math

import numpy as np
import pytest

from calibration.test_bounds import found_with
from cg2raw.calibration.darks import DarkCurrent, DarkSpread, Tails
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.flats import Light, PhotonTransfer
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites
from cg2raw.calibration.structure import BiasStructure, Glow
from cg2raw.calibration.table import as_text, rows_of, told
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


def structure(length):
    """Return that of 300 columns whose first ones fall over so many px."""
    ramp, edge = Measured(2.0, 0.1, "DN"), Measured(5.0, 0.2, "DN")
    profiles = 4 * [np.zeros(300)]
    return BiasStructure(ramp, ramp, edge, Measured(length, 0.5, "px"), *profiles)


TAILS = Tails(Measured(3.0, 0.1, "1"), -0.2, np.zeros(1), 2, np.ones(1), np.ones(1))
RATES = ((-5.0, Measured(1.0, 0.1, "DN/s")), (None, Measured(2.0, 0.1, "DN/s")))
GLOW = [Measured(value, 0.01, "1") for value in (-1.0, 0.5, 0.25)]
SITES = [figure("gain", "e-/DN", 2.0 + n, 0.1, n) for n in range(4)]


def spread(nats):
    """Return rates of pixels whose hot ones are sure, and whose others are by nats."""
    each = (0.1, 0.3, 0.8, 0.01, 20.0)
    law = [Measured(one, one / 20, "DN/s") for one in each]
    return {"spread": DarkSpread(*law, {0.9: 0.5, 0.9999: 60.0}, 0.1, nats, 99.0, 0.0)}


@pytest.mark.parametrize(
    ("fields", "line"),
    [
        ({"structure": structure(9.0)}, "first columns 5.00 +- 0.20 DN over 9.00"),
        ({"structure": structure(50.0)}, "first columns - over more than 50 px, where"),
        ({"tails": TAILS}, "excess kurtosis 3.00 +- 0.10 Tukey lambda at most -0.20"),
        (
            {"dark": DarkCurrent(RATES, None, ())},
            "dark current, median 1.00 +- 0.10 DN/s at -5.0 C",
        ),
        (
            {"glow": Glow(Measured(2.0, 0.1, "DN/s"), *GLOW, 0.1, 0.2, 20.0)},
            "amplifier glow 2.00 +- 0.10 DN/s from row -1, column +0.5",
        ),
        (
            spread(99.0),
            "nonuniformity, rate 0.300 +- 0.015 DN/s above the median, DN/s: "
            "90 %: 0.5 99.99 %: 60 nonuniformity, sigma of log 0.800",
        ),
        (spread(0.0), "nonuniformity, rate - not found; above the median, DN/s: 90 %"),
        (
            spread(0.0),
            "hot pixels 1.000 +- 0.050 % hot pixels, mean rate 20.0 +- 1.0 D",
        ),
        (
            {"fit": Fitted(SITES), "sites": Sites(("R", "Gr", "Gb", "B"))},
            "gain 3.500 +- 0.050 e-/DN R 2.00 Gr 3.00 Gb 4.00 B 5.00",
        ),
        (
            {"light": Light({}, Measured(0.1, 0.01, "1"), 0.023, np.ones((2, 2)))},
            "shading besides, as of dust 2.3 %",
        ),
        ({"lamp": Measured(0.002, 0.0001, "1")}, "frame to frame 0.200 +- 0.010 %"),
        (
            {"transfer": PhotonTransfer([], Measured(999.0, 2.0, "DN"), "full well")},
            "saturation 999.0 +- 2.0 DN full well",
        ),
        ({"transients": {"darks of 0 s": 7}}, "transients 7 pixels in darks of 0 s"),
        ({"notes": ("gain: no flats",)}, "note gain: no flats"),
    ],
)
def test_a_line_tells_a_number_its_unit_and_what_else_is_known(fields, line):
    assert line in " ".join(as_text(found_with(**fields)).split())


def test_each_section_has_its_name_once():
    names = [line for line in as_text(found_with()).splitlines() if line[0] != " "]
    assert names == ["black", "noise", "dark current", "light"]
