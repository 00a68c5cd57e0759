# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shading that is no polynomial, between the tiles that a search looks at."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.assessment.whole_field import on_whole_frames
from cg2raw.diagnose.frames.reader import read_frames
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.synthetic.captures import simulate_captures
from cg2raw.synthetic.measured import Measured
from diagnose.planted import BY_NAME, model_of, on, sensor_of

SHAPE, PIXELS = (240, 320), 12_000
SENSOR = sensor_of(20_000.0)
v, u = (np.indices(SHAPE) + 0.5 - np.reshape(SHAPE, (2, 1, 1)) / 2) / 200
HIDDEN = 1 - 0.3 * (u**2 + v**2) + 0.01 * np.cos(15 * u + 20 * v)


def set_of(pixels):
    """Return (captures of a hidden fall-off, the likelihood of those to fit)."""
    hidden = Measured(transmission=HIDDEN)
    captures = simulate_captures(SENSOR, {}, seed=3, shape=SHAPE, measured=hidden)
    frames = read_frames(captures, noise_models(captures), pixels, lambda *given: None)
    return captures, on([f for f in frames if f.capture.group == "fit"])


@pytest.fixture(scope="module")
def tiled():
    return set_of(PIXELS)


def pieces_of(captures, likelihood):
    return Pieces(captures, Model(SENSOR), None, likelihood)


def fields():
    """Return the terms of a round and tilted lens, (H W, 8), 1 first."""
    r = np.hypot(u, v)
    terms = [np.ones(SHAPE), r**2, r**4, r**6, u, v, u * r**2, v * r**2]
    return np.stack(terms, -1).reshape(-1, 8)


def rms_of(polynomial):
    """Return the relative rms error of coefficients, whatever the exposure."""
    level = fields() @ polynomial / HIDDEN.ravel()
    return np.std(level) / np.mean(level)


def test_it_is_fitted_between_the_tiles(tiled):
    """As near as a polynomial comes that sees all of the field: tiles take the wave for
    a slower one."""
    captures, likelihood = tiled
    in_tiles = fit(model_of(SENSOR, exposure=[0.0], lens_shading=[0.0]), likelihood)
    found = on_whole_frames(in_tiles, pieces_of(captures, likelihood))
    share = 1 / HIDDEN.ravel()[:, None]
    best = np.linalg.lstsq(fields() * share, np.ones(len(share)), rcond=None)[0]
    tiles, whole = (
        rms_of(np.concatenate([[1.0], model.term("lens_shading").values[:7]]))
        for model in (in_tiles, found)
    )
    assert tiles**2 - rms_of(best) ** 2 > 0.0025**2
    assert whole**2 - rms_of(best) ** 2 < 0.0006**2


def test_what_is_not_of_light_rests(tiled):
    captures, likelihood = tiled
    model = model_of(SENSOR, lens_shading=[-0.3], read_noise=[0.02], black_level=[1e-5])
    found = on_whole_frames(model, pieces_of(captures, likelihood))
    assert found.term("lens_shading").values[0] != -0.3
    for name in ("read_noise", "black_level"):
        assert np.array_equal(found.term(name).values, model.term(name).values)


def test_a_model_without_a_field_stays_as_it_is(tiled):
    pieces = pieces_of(*tiled)
    model = model_of(SENSOR, exposure=[0.1])
    assert on_whole_frames(model, pieces) is model
    shading = model_of(SENSOR, lens_shading=[-0.3]).terms[0]
    calibrated = model.with_term(replace(shading, calibration=True))
    assert on_whole_frames(calibrated, pieces) is calibrated


def test_frames_that_were_taken_whole_say_nothing_new():
    captures, likelihood = set_of(SHAPE[0] * SHAPE[1])
    model = model_of(SENSOR, lens_shading=[-0.3])
    assert BY_NAME["lens_shading"].is_field and likelihood.frames[0].tiles.is_whole
    assert on_whole_frames(model, pieces_of(captures, likelihood)) is model
