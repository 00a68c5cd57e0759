# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor that was calibrated warm, and is used cold: less charge of all kinds gathers
without light, and dark current is what is named."""

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.reader import in_groups
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
    """Single darks do not tell the charge of hot pixels and of the glow from that of
    all: it is in the dark current, and what is left of it is said."""
    assert [effect.name for effect in found.effects] == ["dark_current"]
    [dark] = found.effects
    rate = COLDER * RATES["dark_current"]["per_second"]
    assert rate < dark.parameters["per_second"].value < 1.25 * rate
    assert "K colder" in dark.sentence
    assert found.verdict == "partially_explained"
    assert any("most in darks of 30 s" in left.where for left in found.unexplained)
    [updated] = [
        effect
        for effect in Sensor.from_json(found.profile_json, "updated").effects
        if effect["name"] == "dark_current"
    ]
    assert updated["parameters"]["per_second"] == dark.parameters["per_second"].value
