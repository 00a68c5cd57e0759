# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Maps under noise reduction are those of the pixels, and shown as the camera blends
them."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.unblended_frames import unblended
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import ONE, captures_of, frames_of, model_of, on, sensor_of

BLEND = {"blend": 0.3, "diagonal": 0.02}
SIGMA = 6e-4
LISTED = [
    {"name": "noise_reduction", "parameters": BLEND},
    {"name": "dsnu", "parameters": {"sigma": SIGMA}},
]
SENSOR = sensor_of(effects=LISTED)


def shot(sensor, kind="dark", group="fit", seed=1):
    """Return eight frames as the registry draws them."""
    splits = Splits(frames_of(sensor, captures_of([kind] * 8, group)), ONE)
    return drawn_frames(Model(sensor), splits, seed).frames


def test_a_map_is_as_strong_as_the_profile_says():
    """Blended offsets are half as strong."""
    found = fit_patterns(model_of(SENSOR, dsnu=[0.0]), on(shot(SENSOR)))
    assert found.term("dsnu").values == pytest.approx([SIGMA], rel=0.05)
    frames = shot(SENSOR, group="report", seed=2)
    squares = [log_density(found, frame)[1][frame.keep] ** 2 for frame in frames]
    assert np.mean(squares) == pytest.approx(1, abs=0.03)


def test_what_a_map_adds_is_blended():
    frames = shot(SENSOR)
    found = fit_patterns(model_of(SENSOR, dsnu=[0.0]), on(frames))
    offsets = found.term("dsnu").sensor_map.mean
    added = predict(found, frames[0]).mean - predict(Model(SENSOR), frames[0]).mean
    beside = [np.roll(offsets, n, axis) for n in (2, -2) for axis in (1, 2)]
    across = [np.roll(offsets, (a, b), (1, 2)) for a in (2, -2) for b in (2, -2)]
    own = 1 - BLEND["blend"] - BLEND["diagonal"]
    expected = own * offsets + BLEND["blend"] * np.mean(beside, 0)
    expected = expected + BLEND["diagonal"] * np.mean(across, 0)
    np.testing.assert_allclose(added, expected, atol=1e-9)


def test_noise_is_white_and_of_the_variance_before():
    plain = sensor_of(effects=LISTED[:1])
    model, before = unblended(Model(plain), on(shot(plain, "flat")))
    for frame in before.frames:
        p = predict(model, frame)
        z = ((frame.signal - p.mean) / np.sqrt(p.variance))[0, 8:-8, 8:-8]
        assert (z**2).mean() == pytest.approx(1, abs=0.05)
        assert (z[:, 2:] * z[:, :-2]).mean() == pytest.approx(0, abs=0.05)


def test_the_filter_makes_rounding_larger():
    """Of 1 DN of read noise, rounded to whole DN after the blend."""
    levels = {"white_level": 895, "black_level": [64.0] * 4, "bits": 10}
    coarse = sensor_of(10_000.0, 12.0, effects=LISTED[:1], **levels)
    model, before = unblended(Model(coarse), on(shot(coarse)))
    squares = []
    for frame in before.frames:
        p = predict(model, frame)
        z = (frame.signal - p.mean)[0, 8:-8, 8:-8]
        squares.append(np.mean(z**2 / p.variance[0, 8:-8, 8:-8]))
    assert np.mean(squares) == pytest.approx(1, abs=0.02)
    assert before.frames[0].rounding > 1.5 / 12


def test_a_model_without_noise_reduction_stays_as_it_is():
    bare = sensor_of()
    likelihood = on(frames_of(bare, captures_of(["dark"])))
    model = Model(bare)
    assert unblended(model, likelihood) == (model, likelihood)
