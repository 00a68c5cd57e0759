# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Planted values of every effect of light are recovered, and only their names."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.decide import Scenes, decide
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.diagnose.verdict.images import diagnosis_of_images
from cg2raw.diagnose.workers import Workers
from diagnose.planted import (
    BY_NAME,
    FULL_WELL,
    PLANTED,
    READ,
    capture_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)
from tiers import slow

SENSOR = sensor_of()
GROUPS = ("fit", "select", "report")
# Of which tests/diagnose/test_pipeline.py shows the same, with darks.
ELSEWHERE = ["exposure", "lens_shading", "gr_gb_imbalance", "black_level"]
# See test_shapes and test_pipeline: nobody blends noise here.
NOT_HERE = {"full_well", "noise_reduction"}
OTHERS = sorted(PLANTED.keys() - {*ELSEWHERE, *NOT_HERE})


def images(model, seed=7, nuisances=frozenset(), **more):
    """Return (capture set, frames) of two flats and two scenes a group."""
    captures = []
    for k, group in enumerate(GROUPS):
        for n, kind in enumerate(("flat", "flat", "scene", "scene")):
            captures.append(
                capture_of(
                    kind, 4 * k + n, level=0.3 + 0.5 * n, group=group,
                    name=f"{group}{n}", **more,
                )
            )  # fmt: skip
    frames = drawn(frames_of(SENSOR, captures), model, seed)
    return CaptureSet(SENSOR, captures, nuisances), frames


def decided(capture_set, frames, fits_noise=False, names=tuple(PLANTED), doubts=()):
    """Return what is decided of all effects of PLANTED, or of names."""
    return decide(
        capture_set,
        frames,
        names,
        doubts=doubts,
        alpha=0.01,
        most=6,
        fits_noise=fits_noise,
        workers=Workers(1),
        say=lambda *_: None,
    )


def found(model, fits_noise=False, **more):
    return decided(*images(model, **more), fits_noise=fits_noise)


@pytest.mark.parametrize("name", [*OTHERS, *map(slow, ELSEWHERE)])
def test_a_planted_value_is_recovered(name):
    effect, values = BY_NAME[name], np.array(PLANTED[name], float)
    scenes = found(Model(SENSOR).with_effect(effect, values))
    diagnosis = diagnosis_of_images(scenes, False)
    assert [one.name for one in diagnosis.effects] == [name]
    assert diagnosis.verdict == "explained"
    assert diagnosis.gap.chi2_after == pytest.approx(1, abs=0.03)
    assert diagnosis.gap.before > diagnosis.gap.after
    assert_near(diagnosis, effect, values)


def assert_near(diagnosis, effect, values):
    planted = dict(zip(effect.parameters, values, strict=True))
    for parameter, one in diagnosis.effects[0].parameters.items():
        half = (one.ci95[1] - one.ci95[0]) / 2
        # Four standard errors, of sixty parameters.
        assert abs(one.value - planted[parameter]) < 2.1 * half + 1e-9, parameter


@pytest.mark.parametrize("detail", [0.0, 0.05])
def test_a_shape_s_detail_is_found_if_it_is_there(detail):
    model = model_of(SENSOR, lens_shading=(-0.3, *6 * (0.0,), detail))
    scenes = decided(*images(model), names=("lens_shading",))
    diagnosis = diagnosis_of_images(scenes, False)
    found = diagnosis.effects[0].parameters
    assert ("r2_cos2" in found) == bool(detail)
    if detail:
        assert found["r2_cos2"].value == pytest.approx(detail, rel=0.1)


@pytest.mark.parametrize(
    ("value", "far", "moved"),
    [(0, (0, 0), False), (1, (0, 0), True), (0, (1, 0), True), (0, (0, 1), True)],
)
def test_values_and_renders_settle_both(value, far, moved):
    """A value is known to 1; a render moves by pixels, and in brightness."""
    scenes = SimpleNamespace(
        both=SimpleNamespace(covariance=lambda index: np.eye(1)),
        space=SimpleNamespace(index=lambda names: [0], slices={}),
        **{"fitted": [], "effects": [], "model": Model(SENSOR), "theta": np.zeros(1)},
        _likeliest=lambda names: np.array([value]),
        _counted=lambda: np.zeros(1),
        sets={"fit/a": (None, ())},
        placements={"a": None},
        _place=lambda *_: far,
    )
    assert Scenes._move(scenes) == moved


@pytest.mark.parametrize("doubt", ["mains_flicker", "amplifier_mismatch"])
@pytest.mark.parametrize("is_doubted", [True, False])
def test_what_images_do_not_show_may_be_in_place_of_shading(doubt, is_doubted):
    """Waves that are of one phase in all frames by chance; halves that differ. A true
    shading falls off to the corners."""
    capture_set, frames = images(Model(SENSOR))
    changed = []
    for frame in frames:
        v, _ = frame.tiles.places()
        wave = np.cos(np.pi * 1.5 * v) if doubt == "mains_flicker" else np.sign(v)
        changed.append(
            replace(frame, signal=frame.signal * (1 + 0.005 * wave), memo={})
        )
    asked, doubts = ["lens_shading"], [doubt] if is_doubted else []
    found = decided(capture_set, changed, names=asked, doubts=doubts)
    assert found.chosen.names == asked
    assert found.chosen.alike["lens_shading"] == [(one,) for one in doubts]
    true = images(model_of(SENSOR, lens_shading=(-0.1,)))
    assert not decided(*true, names=asked, doubts=[doubt]).chosen.alike["lens_shading"]


def test_distortion_is_no_registration():
    """Renders may lie anywhere, turned and scaled: what bends lines is the lens."""
    effect, values = BY_NAME["lens_distortion"], np.array([1.5, 0.5])
    scenes = found(
        Model(SENSOR).with_effect(effect, values), nuisances=frozenset({"registration"})
    )
    diagnosis = diagnosis_of_images(scenes, False)
    assert [one.name for one in diagnosis.effects] == ["lens_distortion"]
    assert_near(diagnosis, effect, values)


def test_nothing_planted_is_nothing_named():
    diagnosis = diagnosis_of_images(found(Model(SENSOR)), True)
    assert (diagnosis.verdict, diagnosis.effects) == ("consistent", [])
    assert {one.name for one in diagnosis.detection_limits} >= {"blur", "exposure"}
    assert len(diagnosis.pictures) == 4


def test_noise_that_nobody_knows_is_fitted():
    noisy = Model(SENSOR).with_effect(BY_NAME["read_noise"], np.array([0.8]))
    noisy = noisy.with_effect(BY_NAME["shot_noise"], np.array([0.4]))
    scenes = found(noisy, fits_noise=True)
    assert scenes.chosen.names == []
    assert np.log(scenes.model.noise_gain("beta1")) == pytest.approx(0.4, abs=0.03)
    # Of 1 % of the variance: darks would tell it.
    assert abs(np.log(scenes.model.noise_gain("beta2"))) < 1.5
    assert scenes.grams["report"].squares / scenes.grams["report"].n == pytest.approx(
        1, abs=0.03
    )


PHOTONS = "poisson_shot_noise"


@pytest.mark.parametrize(
    ("names", "of_light", "found"),
    [
        ([PHOTONS], "shot_noise", [PHOTONS]),
        ([PHOTONS], PHOTONS, []),
        (["exposure"], "shot_noise", []),
    ],
)
def test_photons_are_named_if_asked_for_and_not_stated(names, of_light, found):
    sensor = sensor_of(noise_effects=[of_light, "read_noise"])
    captures = [
        capture_of("flat", n, level=0.003, group=group, name=f"{group}{n}")
        for n, group in enumerate(3 * GROUPS)
    ]
    frames, rng = [], np.random.default_rng(1)
    for frame in frames_of(sensor, captures):
        charge = rng.poisson(FULL_WELL * predict(Model(sensor), frame).mean)
        signal = charge / FULL_WELL + READ * rng.standard_normal(charge.shape)
        frames.append(replace(frame, signal=signal))
    assert [*decided(CaptureSet(sensor, captures), frames, names=names).nats] == found


@pytest.mark.parametrize(
    ("of", "change", "message"),
    [
        ("camera", lambda light: 40 * light, "0.0% of its pixels are predicted"),
        ("at_white", np.ones_like, "0.0% of its pixels are predicted"),
        ("camera", np.zeros_like, r"correlate by 0\.0\d of what noise leaves"),
        ("signal", np.zeros_like, r"correlate by 0\.0\d of what noise leaves"),
        ("signal", lambda of: of[:, ::-1, ::-1], "does not correspond to the capture"),
    ],
)
def test_scenes_that_say_nothing_are_refused(of, change, message):
    capture_set, frames = images(Model(SENSOR))
    changed = [
        replace(frame, **{of: change(getattr(frame, of)), "memo": {}})
        if frame.capture.kind == "scene"
        else frame
        for frame in frames
    ]
    with pytest.raises(ValueError, match=message):
        decided(capture_set, changed)


@pytest.mark.parametrize("group", GROUPS)
def test_a_group_without_frames_is_refused(group):
    capture_set, frames = images(Model(SENSOR))
    others = [frame for frame in frames if frame.capture.group != group]
    with pytest.raises(ValueError, match=f"no frame is in the group {group}"):
        decided(capture_set, others)
