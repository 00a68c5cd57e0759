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


@pytest.mark.parametrize(
    ("name", "along", "alike"),
    [("column_fixed_pattern", (0, 1), 32), ("dsnu", (0,), 1)],
)
def test_the_mean_of_a_map_is_some_of_a_black_level(frames, name, along, alike):
    """Columns of 96, half of which have a site; its pixels, a quarter of all."""
    darks = [frame for frame in frames if not frame.capture.shows.light] * 4
    sigma = 2 * np.sqrt(darks[0].beta2.mean())
    shape = [1 if axis in along else n for axis, n in enumerate(darks[0].signal.shape)]
    offsets = sigma * np.random.default_rng(8).standard_normal(shape)
    shown = on(drawn(darks, model_of(SENSOR), 5, extra=lambda *_: offsets))
    model = fit(model_of(SENSOR, black_level=[0.0] * 4, **{name: [sigma]}), shown)
    known = model.term(name).values[0]
    own = known / np.sqrt(darks[0].signal.size / 4 / alike)
    for one in estimates(model, shown)["black_level"].values():
        error = (one.ci95[1] - one.ci95[0]) / (2 * 1.96)
        assert own < error < 1.25 * own


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


def test_columns_of_frames_of_another_width_are_others():
    """As of a masked border beside its frame, of which a tile lies at the origin, too:
    what maps do to the scores of both is the sum of what they do to those of each."""
    frames = frames_of(SENSOR, captures_of(("dark", "dark")))
    narrow = captures_of(("dark", "dark"), shape=(64, 48))
    frames += frames_of(SENSOR, narrow)
    assert len({frame.tiles.origins.tobytes() for frame in frames}) == 1
    sigma = 2 * np.sqrt(frames[0].beta2.mean())

    def columns(frame, _):
        width = frame.signal.shape[-1]
        return sigma * np.random.default_rng(width).standard_normal(width)

    shown = drawn(frames, model_of(SENSOR), 5, extra=columns)
    model = model_of(SENSOR, black_level=[0.0] * 4, column_fixed_pattern=[sigma])
    model, by_maps = fit(model, on(shown)), {}
    for name, some in {"both": shown, "wide": shown[:2], "narrow": shown[2:]}.items():
        base = Linearisation(model, on(some))
        _, score, information = base.system(model)
        found = covariances(base, score, information)
        drawn_maps = found.expected - found.by_noise
        by_maps[name] = information @ drawn_maps @ information
    assert all(np.diag(by_maps[name]).min() > 0 for name in ("wide", "narrow"))
    parts = by_maps["wide"] + by_maps["narrow"]
    np.testing.assert_allclose(by_maps["both"], parts, rtol=1e-6)
