# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor that was calibrated warm, and is used cold: less charge of all kinds gathers
without light, and dark current is what is named."""

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.reader import in_groups
from cg2raw.model.figures import NORMAL
from diagnose.closed_loop import simulated
from diagnose.planted import READ, capture_of, sensor_of

pytestmark = pytest.mark.slow

SHAPE = (240, 320)
COLDER = 0.45  # of the charge
RATES = {
    "dark_current": {"per_second": 0.3 * READ},
    "dark_current_nonuniformity": {"rate": 0.1 * READ, "log_sigma": 0.8},
    "hot_pixels": {"fraction": 0.01, "rate": 4 * READ},
    "amplifier_glow": {
        "per_second": 0.3 * READ, "row": -1.0, "column": 1.0, "extent": 0.3,
    },
}  # fmt: skip
RATE_OF = {"dark_current_nonuniformity": "rate", "hot_pixels": "rate"}


def sensor_at(warmth):
    listed = [{"name": "dsnu", "parameters": {"sigma": 0.3 * READ}}]
    for name, parameters in RATES.items():
        rate = RATE_OF.get(name, "per_second")
        warm = {**parameters, rate: warmth * parameters[rate]}
        listed.append({"name": name, "parameters": warm})
    return sensor_of(effects=listed)


@pytest.fixture(scope="module")
def found():
    """Of three darks of three times, as few as anybody would try, pixels divided."""
    shots = [
        capture_of("dark", n, shape=SHAPE, exposure_time=time)
        for n, time in enumerate((2.0, 4.0, 30.0))
    ]
    cold = sensor_at(COLDER)
    darks = simulated(CaptureSet(cold, shots), cold).captures
    parts = [part for dark in darks for part in in_groups(dark, None)]
    return diagnose(CaptureSet(sensor_at(1.0), parts), details=False, threads=2)


def test_a_colder_sensor_has_less_dark_current_and_no_other_effect(found):
    assert [effect.name for effect in found.effects] == ["dark_current"]
    [dark] = found.effects
    rate = RATES["dark_current"]["per_second"]
    found_rate = dark.parameters["per_second"]
    error = (found_rate.ci95[1] - found_rate.ci95[0]) / (2 * NORMAL)
    assert found_rate.value == pytest.approx((COLDER - 1) * rate, abs=3 * error)
    assert error < 0.02 * rate
    assert "K colder" in dark.sentence
    assert found.gap.chi2_after == pytest.approx(1, abs=0.02)


def test_the_updated_profile_is_that_of_the_colder_sensor(found):
    for effect in Sensor.from_json(found.profile_json, "updated").effects:
        name = effect["name"]
        if name in RATES:
            rate = RATE_OF.get(name, "per_second")
            expected = COLDER * RATES[name][rate]
            assert effect["parameters"][rate] == pytest.approx(expected, rel=0.03)
