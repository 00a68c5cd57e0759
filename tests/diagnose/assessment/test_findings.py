# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Findings: an e-value is written as far as a double holds it, and says so beyond."""

import numpy as np
import pytest

from cg2raw.diagnose.assessment.findings import findings_of
from cg2raw.diagnose.diagnosis import LARGEST_E, Estimate
from cg2raw.diagnose.inference.model_selection import Step
from diagnose.planted import model_of, sensor_of


@pytest.mark.parametrize(
    ("nats", "is_largest"),
    [(5e4, True), (float(np.log(LARGEST_E)), True), (600.0, False)],
)
def test_the_largest_evidence_is_reported_as_such(nats, is_largest):
    model = model_of(sensor_of(), exposure=[0.1])
    steps = [Step("added", "exposure", nats, nats)]
    values = {"exposure": {"gain": Estimate(0.1, "1", (0.09, 0.11))}}
    (finding,) = findings_of(model, steps, values, False)
    assert finding.e_value <= LARGEST_E
    assert (finding.e_value == LARGEST_E) == is_largest


def test_a_name_that_was_not_tested_in_time_is_no_finding():
    model = model_of(sensor_of(), exposure=[0.1])
    assert findings_of(model, [], {}, False) == []
