# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which candidates may be added beside effects that explain far more."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.inference.admission import Admission, acts_on
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model, Term
from diagnose.planted import BY_NAME, ONE, READ, SHAPE, capture_of, drawn, frames_of
from diagnose.planted import sensor_of as made

SENSOR = made()
LARGER = "dark_current_nonuniformity"  # 1 % of what it explains may be black level
OFFSET = 0.1 * READ
THRESHOLD = 8.0


def uneven():
    """Return a model with a map of rates, as uneven as three read noises in 60 s."""
    rates = READ / 20 * np.random.default_rng(1).exponential(1, (1, *SHAPE))
    known = SensorMap(rates, np.zeros_like(rates))
    return Model(SENSOR, (Term(BY_NAME[LARGER], np.array([0.5, READ / 20]), known),))


def splits_of(model, times, extra):
    captures = [
        capture_of("dark", n, name=f"dark{n}", group="select", exposure_time=time)
        for n, time in enumerate(times)
    ]
    return Splits(drawn(frames_of(SENSOR, captures), model, 2, extra), ONE)


def admitted(name, values, times, extra, loss=1e6):
    """Return (whether an effect is admitted beside the map, what it gains)."""
    null = uneven()
    splits = splits_of(null, times, extra)
    model = null.with_effect(BY_NAME[name], np.asarray(values))
    gain = splits.select.total(model) - splits.select.total(null)
    candidates = SimpleNamespace(splits=splits, null=null, threshold=THRESHOLD)
    trial = Trial(name, gain, np.array([gain]), model, gain)
    return Admission(candidates, 0.0, {LARGER: loss}).admits(trial), gain


def test_a_map_of_rates_acts_on_long_darks_alone():
    null = uneven()
    frames = splits_of(null, [0.0, 60.0], 0.0).frames
    assert [acts_on(null, LARGER, frame) for frame in frames] == [False, True]


@pytest.mark.parametrize(
    ("times", "loss", "expected"),
    [
        ([0.0, 0.0, 60.0, 60.0], 1e6, True),  # short darks have it, too
        ([60.0] * 4, 1e6, False),  # it may be what the map lacks
        ([60.0] * 4, 100.0, True),  # more than a hundredth of it
    ],
)
def test_an_offset_beside_uneven_dark_current(times, loss, expected):
    found, gain = admitted("black_level", [OFFSET] * 4, times, OFFSET, loss)
    assert 20 < gain < 1e4
    assert found is expected


def test_noise_is_not_asked_elsewhere():
    """What is hot in long darks is noisier in short ones, too."""

    def drifting(frame, rng):
        return OFFSET * rng.standard_normal()

    times = [0.0] * 12
    found, gain = admitted("black_level_drift", [0.1], times, drifting)
    assert gain > THRESHOLD and not found
    assert admitted("black_level_drift", [0.1], times, drifting, 100.0)[0]
