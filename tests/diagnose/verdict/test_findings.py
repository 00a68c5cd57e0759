# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A finding has how sure it is, what may be in its place, and what would tell them."""

import math

import pytest

from cg2raw.diagnose.diagnosis import Alternative
from cg2raw.diagnose.verdict.findings import deciding_captures, finding_of
from diagnose.planted import sensor_of

SENSOR = sensor_of(effects={"prnu": {"sigma": 0.01}})


@pytest.mark.parametrize(("nats", "e_value"), [(math.log(50), 50), (1e4, 1e300)])
def test_an_e_value_is_the_likelihood_that_is_lost(nats, e_value):
    found = finding_of("prnu", {}, nats, SENSOR, True, instead=("dsnu", 3.0))
    assert (found.gain_nats, found.e_value) == (nats, pytest.approx(e_value))
    assert found.alternatives == [Alternative("dsnu", 3.0)]
    assert found.provisional and found.stated
    assert not finding_of("dsnu", {}, nats, SENSOR, False).stated


def test_what_to_capture_is_said_of_each_pair_that_looks_alike():
    findings = [
        finding_of("exposure", {}, 9.0, SENSOR, False),
        finding_of("read_noise", {}, 9.0, SENSOR, False, ["shot_noise", "dsnu"]),
    ]
    first, second = deciding_captures(findings)
    assert first.startswith("To tell read noise from shot noise gain: Darks, and flats")
    assert second.startswith("To tell read noise from DSNU: ")
