# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What images say: the noise of a profile without any."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.verdict.images import noise_row
from diagnose.planted import bare, model_of, sensor_of


def test_a_profile_without_noise_gets_that_of_its_first_iso():
    """With what the images found to multiply it; one number stands for all sites."""
    frames = [
        SimpleNamespace(
            noise=NoiseModel((beta1,), (1e-3 * beta1,), measured=False),
            capture=SimpleNamespace(iso=iso),
        )
        for iso, beta1 in ((None, 3e-4), (400.0, 4e-4), (100.0, 1e-4))
    ]
    found = SimpleNamespace(
        views=[SimpleNamespace(frame=frame) for frame in frames],
        capture_set=SimpleNamespace(sensor=bare(sensor_of())),
        model=model_of(sensor_of(), shot_noise=[np.log(2)]),
    )
    assert noise_row(found) == {
        "iso": 400.0,
        "beta1": pytest.approx([8e-4] * 4),
        "beta2": pytest.approx([4e-7] * 4),
    }
    found.views = found.views[:1]
    assert noise_row(found) is None
