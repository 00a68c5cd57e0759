# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Robust errors: those of noise where a model is right, wider where it is not."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.frames.reader import PIXELS, read_frames
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.intervals import SmoothValues, estimates
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.inference.robust_errors import covariances
from diagnose.patch_tables import write_tables
from diagnose.planted import captures_of, drawn, frames_of, model_of, on, sensor_of

SENSOR = sensor_of()
NAMES = ("exposure", "black_level", "read_noise")
DRAWS = 12


@pytest.fixture(scope="module")
def frames():
    return frames_of(SENSOR, captures_of(("flat", "flat", "scene", "dark", "dark")))


def null_of(*names):
    return model_of(SENSOR, **{name: [0.0] for name in names})


def misfit(seed):
    """Return what makes a part of all frames brighter or darker, the same in each."""
    rng = np.random.default_rng(seed)
    left, top, strength = rng.uniform(-0.5, 0.5), rng.uniform(-0.3, 0.3), rng.normal()

    def add(frame, _):
        u, v = frame.tiles.field()
        bump = np.exp(-((u - left) ** 2 + (v - top) ** 2) / (2 * 0.2**2))
        return 0.05 * strength * bump * frame.of_site(frame.camera.astype(float))

    return add


def widened(model, shown):
    """Return (how much wider than by noise errors are, by parameter; information)."""
    base = Linearisation(model, shown)
    parameters, score, information = base.system(model)
    found = covariances(base, score, information)
    noise = np.sqrt(np.diag(found.by_noise))
    wider = np.divide(found.errors, noise, np.ones_like(noise), where=noise > 0)
    return dict(zip(parameters, wider, strict=True)), information


def test_of_a_right_model_errors_are_those_of_noise(frames):
    model, wider = null_of(*NAMES), []
    for seed in range(DRAWS):
        found, _ = widened(model, on(drawn(frames, model_of(SENSOR), seed)))
        wider += found.values()
    assert len(wider) == DRAWS * 6  # black level has four sites
    assert np.mean(np.array(wider) > 1.001) < 0.03


def test_they_hold_what_a_wrong_model_makes_of_a_value(frames):
    by_noise, robust = [], []
    for seed in range(DRAWS):
        shown = on(drawn(frames, model_of(SENSOR), seed, extra=misfit(seed)))
        model = fit(null_of("exposure"), shown)
        wider, information = widened(model, shown)
        (interval,) = estimates(model, shown)["exposure"].values()
        half = (interval.ci95[1] - interval.ci95[0]) / 2
        by_noise.append(abs(interval.value) * np.sqrt(information[0, 0]) > 1.96)
        robust.append(abs(interval.value) > half)
        of_one = SmoothValues.of(model, shown).widening("exposure")
        assert of_one == pytest.approx(wider["exposure", 0] ** 2)
    assert np.mean(by_noise) > 0.9
    assert np.mean(robust) < 0.2


def test_what_nothing_tells_is_not_wider(frames):
    darks = on([frame for frame in frames if not frame.capture.shows.light])
    model = null_of("exposure", "read_noise")
    wider, _ = widened(model, darks)
    assert wider["exposure", 0] == pytest.approx(1)
    assert SmoothValues.of(model, darks).widening("exposure") == 1
    assert widened(model_of(SENSOR), darks)[0] == {}


def test_a_value_that_is_not_fitted_is_no_wrong_model(frames):
    shown = on(drawn(frames, model_of(SENSOR, exposure=[0.05]), 3))
    wider, _ = widened(model_of(SENSOR, exposure=[0.02]), shown)
    assert wider["exposure", 0] == pytest.approx(1)


def test_patches_of_a_chart_are_a_place_each(tmp_path):
    """They lie nowhere: as many as there are say how far scores differ."""
    captures = read_captures(write_tables(tmp_path, offset=0.02))
    frames = read_frames(captures, noise_models(captures), PIXELS, lambda *_: None)
    fitted = [frame for frame in frames if frame.capture.group == "fit"]
    model = fit(model_of(captures.sensor, black_level=[0.0]), on(fitted))
    base = Linearisation(model, on(fitted))
    _, score, information = base.system(model)
    found = covariances(base, score, information)
    patches = {len(frame.signal) for frame in fitted}
    assert {round(found.places)} == patches
    assert (found.errors > 0).all()
