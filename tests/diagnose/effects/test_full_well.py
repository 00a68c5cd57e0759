# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.effects.catalogue import effect


@pytest.mark.parametrize(
    ("below_white", "nats"), [(0.2, 50.0 + 12.5), (0.15, 12.5 + 0.0), (0.05, 0.0)]
)
def test_a_well_gains_half_a_square_of_each_bright_pixel_above_it(below_white, nats):
    """Of pixels at 0.9 and 0.85 with noise of 0.01; others are dark, at white, or do
    not count."""
    mean = np.array([[[0.9, 0.85, 0.19, 0.95, 0.95]]])
    at_white = np.array([[[False, False, False, True, False]]])
    keep = np.array([[[True, True, True, True, False]]])
    p = SimpleNamespace(mean=mean, variance=np.full(mean.shape, 1e-4))
    frame = SimpleNamespace(keep=keep, at_white=at_white)
    gain = effect("full_well").expected_gain([(frame, p)])
    assert gain(below_white) == pytest.approx(nats, abs=1e-9)
