# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Read noise: it is found by the likelihood, where squares lead astray."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Term
from diagnose.planted import (
    BY_NAME,
    ONE,
    READ,
    captures_of,
    frames_of,
    model_of,
    sensor_of,
)


def test_read_noise_is_found_beside_pixels_that_jump():
    """Their squares say that noise is more than the profile's, and it is 23 % less: by
    scores, which are squares, there was no step to it."""
    jumps = {"fraction": 0.01, "amplitude": 30 * READ}
    effects = [
        {"name": "dsnu", "parameters": {"sigma": READ}},
        {"name": "random_telegraph_noise", "parameters": jumps},
    ]
    sensor = sensor_of(effects=effects)
    frames = frames_of(sensor, captures_of(("dark",) * 4, shape=(96, 144)))
    planted = model_of(sensor, read_noise=[-0.26])
    likelihood = drawn_frames(planted, Splits(frames, ONE), 4).fit
    model = model_of(sensor, random_telegraph_noise=list(jumps.values()))
    model = model.with_term(Term(BY_NAME["dsnu"], np.zeros(1), calibration=True))
    for _ in range(3):
        model = fit_patterns(model, likelihood)
    effect = BY_NAME["read_noise"]
    begun, gain = first_guess(effect, Linearisation(model, likelihood))
    assert gain > 100
    found = fit(begun, likelihood).term("read_noise").values
    assert found == pytest.approx([-0.26], abs=0.12)
