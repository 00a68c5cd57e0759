# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Nuisances: fields are integrated out as their dense covariance says."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.inference.nuisance_fit import (
    nuisance_of,
    refitted,
    without_highlights,
)
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.nuisance import Nuisance
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import capture_of, drawn, frames_of, model_of, on, sensor_of

SENSOR = sensor_of()
ALL = frozenset({"light", "radiance", "exposure"})


def nuisance(light=0.02, radiance=0.03, registration=0.0, texture=0.0, floating=ALL):
    return Nuisance(light, radiance, registration, texture, floating)


@pytest.mark.parametrize("kind", ["scene", "flat"])
@pytest.mark.parametrize("floating", [ALL, ALL | {"white_balance"}])
def test_whitening_is_the_dense_normal(kind, floating):
    (frame,) = frames_of(SENSOR, [capture_of(kind, shape=(24, 30))])
    rng = np.random.default_rng(1)
    frame = replace(frame, keep=frame.keep & (rng.random(frame.keep.shape) < 0.8))
    one = nuisance(floating=floating)
    p = predict(Model(SENSOR), frame)
    z = rng.standard_normal(frame.signal.shape)
    white, cost = one.shrinkage(p, frame).apply(z, frame.keep)
    keep = frame.keep
    density = (-0.5 * white**2 - 0.5 * np.log(2 * np.pi) + cost)[keep].sum()
    columns = one._columns(frame, p)[:, keep.ravel()].astype(float)
    covariance = np.eye(keep.sum()) + columns.T @ columns
    expected = multivariate_normal(cov=covariance).logpdf(z[keep])
    assert density == pytest.approx(expected, rel=1e-4)


def test_a_dark_has_no_nuisance():
    (frame,) = frames_of(SENSOR, [capture_of("dark")])
    z = np.ones(frame.signal.shape)
    p = predict(Model(SENSOR), frame)
    white, cost = nuisance().shrinkage(p, frame).apply(z, frame.keep)
    assert (white == z).all() and np.sum(cost) == 0
    assert nuisance(registration=1.0, texture=1.0).pixel_variance(frame, z) == 0


def test_brightness_that_flickers_is_no_evidence():
    """Frames that are 2 % brighter cost a model hundreds of nats, and few with it."""
    frames = frames_of(SENSOR, [capture_of("flat"), capture_of("scene")])

    def brighter(frame, rng):
        return 0.02 * predict(Model(SENSOR), frame).exposed

    shown = drawn(frames, Model(SENSOR), 2, brighter)
    still = drawn(frames, Model(SENSOR), 2)
    base = Model(SENSOR)
    floating = replace(base, nuisance=nuisance())
    assert on(still).total(base) - on(shown).total(base) > 100
    assert on(still).total(floating) - on(shown).total(floating) < 15


def test_sizes_are_recovered():
    """Light from frame to frame of 3 %, of 12 frames."""
    captures = [capture_of("flat", n, group="fit") for n in range(12)]
    frames = frames_of(SENSOR, captures)
    size = 0.03

    def flicker(frame, rng):
        return size * rng.standard_normal() * predict(Model(SENSOR), frame).exposed

    shown = drawn(frames, Model(SENSOR), 4, flicker)
    start = nuisance(light=0.005, radiance=0.0, floating=frozenset({"light"}))
    found = refitted(Model(SENSOR, nuisance=start), on(shown))
    assert found.light == pytest.approx(size, rel=0.5)
    quiet = refitted(Model(SENSOR, nuisance=start), on(drawn(frames, Model(SENSOR), 5)))
    assert quiet.light == pytest.approx(0.005)


def test_no_nuisance_is_declared_and_none_is_there():
    frames = frames_of(SENSOR, [capture_of("dark"), capture_of("scene")])
    declared = CaptureSet(SENSOR, [f.capture for f in frames])
    assert nuisance_of(declared, on(frames)) is None


def test_declared_lower_bounds_hold():
    frames = drawn(
        frames_of(SENSOR, [capture_of("scene", n) for n in (1, 2)]), Model(SENSOR), 6
    )
    declared = CaptureSet(
        SENSOR,
        [f.capture for f in frames],
        nuisances=frozenset({"light", "radiance"}),
        uncertainty={"light": 0.02, "radiance": 0.04},
    )
    found = nuisance_of(declared, on(frames))
    assert found.light >= 0.02 and found.radiance >= 0.04


def test_highlights_of_scenes_do_not_count():
    frames = frames_of(SENSOR, [capture_of("scene"), capture_of("flat", level=0.95)])
    brighter = model_of(SENSOR, exposure=[0.6])
    for frame in frames:
        less = without_highlights(frame, brighter)
        hidden = frame.keep & ~less.keep
        bright = predict(brighter, frame).mean >= 0.85
        shown = frame.capture.kind == "scene"
        assert (hidden == (frame.keep & bright & shown)).all()
        assert (less.counted == frame.keep).all()
    assert hidden.sum() == 0


def test_highlights_show_what_clips_and_little_else():
    frames = frames_of(SENSOR, [capture_of("scene", n) for n in range(4)])
    hidden = nuisance(0.01, 0.02, registration=0.1)
    bright = replace(model_of(SENSOR, exposure=[1.5]), nuisance=hidden)
    truth = replace(model_of(SENSOR, exposure=[1.5], full_well=[0.08]))
    seen = [without_highlights(frame, bright) for frame in drawn(frames, truth, 3)]
    assert sum(frame.highlights.sum() for frame in seen) > 100

    def gain(**terms):
        model = replace(model_of(SENSOR, exposure=[1.5], **terms), nuisance=hidden)
        return on(seen).total(model) - on(seen).total(bright)

    clipped = gain(full_well=[0.08])
    assert clipped > 100
    assert gain(full_well=[0.06]) < 0.5 * clipped
    assert gain(nonlinearity=[0.05, 0.0]) < 0.3 * clipped


def test_a_shift_is_variance_on_edges():
    (frame,) = frames_of(SENSOR, [capture_of("scene")])
    p = predict(Model(SENSOR), frame)
    extra = nuisance(0, 0, registration=0.3).pixel_variance(frame, p.variance)
    green = frame.camera[0, 1].astype(float)
    slope = np.gradient(green, axis=0) ** 2 + np.gradient(green, axis=1) ** 2
    at = frame.color == 1
    assert extra[0][at] == pytest.approx(0.09 * slope[at], abs=1e-9)


def test_memory_of_what_is_kept_is_bounded():
    """Per frame, what whitening keeps is below 150 bytes a pixel."""
    (frame,) = frames_of(SENSOR, [capture_of("scene")])
    p = predict(Model(SENSOR, nuisance=nuisance()), frame)
    assert p.shrinkage.columns.nbytes / frame.signal.size < 150
