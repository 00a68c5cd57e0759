# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import math
from types import SimpleNamespace

import numpy as np
import pytest

from calibration.planted import ISO, sensor_of
from calibration.test_table import figure
from cg2raw.calibration.fitting import (
    changed,
    in_dn,
    lowest_code,
    of_all,
    of_flats,
    within_code,
)
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.sites import Sites


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


@pytest.mark.parametrize(
    ("lights", "sensor", "lost", "more"),
    [
        ((100.0, 102.0), {}, "", 0.0),  # the profile's noise is known
        ((100.0, 102.0), {"noise": []}, "", None),
        ((100.0, 200.0), {"noise": []}, "", 0.0),  # of two levels
        ((100.0, 102.0), {}, "coarse", (0.24 - 1 / 12) / math.sqrt(12) / 101),
        ((100.0, 200.0), {}, "coarse", 0.0),
    ],
)
def test_gain_of_flats_of_one_level_is_as_sure_as_noise_without_light(
    lights, sensor, lost, more
):
    """Of codes that hide it, an even law of variances up to 0.24 DN^2: an error of
    0.045 DN^2, over 101 DN of light. Their darks' one code tells black to 1 / sqrt(12).
    """
    seen = SimpleNamespace(
        levels=lambda number: np.array([256.0 + lights[number]]),
        sites=Sites(("",)),
        sensor=sensor_of(**sensor),
    )
    given = [figure("gain", "e-/DN", 2.0, 0.1), figure("PRNU", "1", 0.01, 0.001)]
    found = of_flats(given, seen, [0, 1], np.array([256.0]), ISO, lost)
    gain, black = (of_all(found, name) for name in ("gain", "black level"))
    if more is None:
        assert gain is None
    else:
        error = math.hypot(0.1, 2.0**2 * more)
        assert gain == Measured(2.0, pytest.approx(error), "e-/DN")
    known = Measured(256.0, pytest.approx(12**-0.5), "DN")
    assert black == (known if lost else None)
    assert of_all(found, "PRNU") == Measured(0.01, 0.001, "1")


@pytest.mark.parametrize(("is_cut", "code"), [(True, 21), (False, 1)])
def test_codes_are_counted_from_the_lowest_that_their_steps_lie_on(is_cut, code):
    """Of 21 and 25 in darks, 41 in flats: steps of 4 DN from 1 DN on."""
    codes = np.bincount([21, 25, 48 + 41], minlength=2 * 48).reshape(2, 48)
    seen = SimpleNamespace(
        darks=[0],
        sites=SimpleNamespace(step=4),
        statistics=SimpleNamespace(planes=[SimpleNamespace(codes=codes)]),
    )
    assert lowest_code(seen, is_cut) == code


@pytest.mark.parametrize(("error", "known"), [(0.1, 0.1), (0.5, 12**-0.5)])
def test_a_level_is_known_to_an_even_law_within_a_code_at_least(error, known):
    found = within_code(figure("black level", "DN", 10.2, error, site=3))
    assert found.standard_error == pytest.approx(known)
    assert (found.value, found.site) == (10.2, 3)
    assert found.high - found.value == pytest.approx(2 * known, rel=0.03)
