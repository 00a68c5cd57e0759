# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Drawn frames: captures of a model, by the registry."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import ONE, captures_of, frames_of, model_of, on, sensor_of

SENSOR = sensor_of()
KINDS = ("dark", "flat", "scene") * 2


def splits_of(sensor=SENSOR, **more):
    return Splits(frames_of(sensor, captures_of(KINDS, **more)), ONE)


@pytest.mark.parametrize(
    "terms",
    [
        {},
        {"exposure": [0.2], "read_noise": [0.7]},
        {"row_noise": [0.5], "read_noise_correlation": [0.1]},
        {"noise_reduction": [0.3, 0.02], "heavy_tailed_noise": [0.05, 20.0]},
    ],
)
def test_residuals_of_a_model_on_what_it_draws_are_white(terms):
    model = model_of(SENSOR, **terms)
    drawn = drawn_frames(model, splits_of(), 1)
    for frame in drawn.frames:
        z = log_density(model, frame)[1][frame.keep]
        assert z.mean() == pytest.approx(0, abs=0.06)
        assert (z**2).mean() == pytest.approx(1, abs=0.06)
    right = on(drawn.frames).total(model)
    wrong = on(drawn.frames).total(Model(SENSOR)) if terms else -np.inf
    assert right > wrong


def test_a_seed_draws_the_same_and_another_one_does_not():
    splits, model = splits_of(), Model(SENSOR)
    one, same, other = (drawn_frames(model, splits, seed).frames for seed in (1, 1, 2))
    for a, b, c, given in zip(one, same, other, splits.frames, strict=True):
        np.testing.assert_array_equal(a.signal, b.signal)
        assert (a.signal != c.signal).mean() > 0.5
        assert a.capture is given.capture and a.keep is given.keep


def test_large_frames_are_drawn_in_their_tiles():
    captures = captures_of(("flat", "dark"), shape=(512, 640))
    frames = frames_of(SENSOR, captures, pixels=32768)
    assert len(frames[0].tiles.origins) > 1
    model = model_of(SENSOR, lens_shading=[-0.3, 0, 0, 0, 0, 0, 0])
    drawn = drawn_frames(model, Splits(frames, ONE), 1)
    z = log_density(model, drawn.frames[0])[1][frames[0].keep]
    assert (z**2).mean() == pytest.approx(1, abs=0.03)


def test_captures_without_an_iso_are_not_drawn():
    splits = splits_of()
    unknown = [
        replace(frame, capture=replace(frame.capture, iso=None))
        for frame in splits.frames
    ]
    assert drawn_frames(Model(SENSOR), Splits(unknown, ONE), 1) is None
