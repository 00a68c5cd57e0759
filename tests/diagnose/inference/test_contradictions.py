# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Fixed patterns that are not as strong as a profile says are findings."""

import json
from dataclasses import replace

import numpy as np
import pytest

from calibration.planted import PATTERNS, RANGE, frames_of, sensor_of
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.reader import LIGHT_OF_DARKS, dark
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.inference.contradictions import contradicted
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.report.text import verdict_sentence
from diagnose.planted import ONE, READ, drawn, model_of
from diagnose.planted import SHAPE as FRAME
from diagnose.planted import capture_of as planted_capture
from diagnose.planted import frames_of as planted_frames
from diagnose.planted import sensor_of as made

SHAPE = (96, 128)


def as_capture(frame, group):
    """Return a dark or flat of a calibration as a capture."""
    return Capture(
        name=frame.name,
        kind=frame.kind,
        shape=SHAPE,
        group=group,
        set=frame.name,
        illuminant=LIGHT_OF_DARKS,
        iso=frame.iso,
        exposure_time=frame.exposure_time,
        raw=frame.pixels,
        scene=dark if frame.kind == "dark" else None,
    )


def diagnosed(without=(), **said):
    """Return the diagnosis of frames by a profile that says something else of some
    effects. without : names that are not asked for."""
    camera = sensor_of(PATTERNS, shape=SHAPE)
    frames = frames_of(camera, biases=6, darks=6, flats=6)
    turns = {"dark": 0, "flat": 0}
    captures = []
    for frame in frames:
        group = GROUPS[turns[frame.kind] % 3]
        turns[frame.kind] += 1
        captures.append(as_capture(frame, group))
    sensor = sensor_of(PATTERNS | said, shape=SHAPE)
    return diagnose(CaptureSet(sensor, captures), details=False, without=without)


@pytest.mark.slow
def test_a_profile_that_is_right_is_not_contradicted():
    assert diagnosed().verdict == "consistent"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("prnu", {"sigma": 0.006}),
        ("dsnu", {"sigma": 3.5 / RANGE}),
        ("column_fixed_pattern", {"sigma": 0.1 / RANGE}),
        ("hot_pixels", {"fraction": 0.002, "rate": 4 / RANGE}),
        ("dark_current_nonuniformity", {"rate": 0.15 / RANGE, "log_sigma": 0.5}),
    ],
)
def test_the_one_that_a_profile_says_wrongly_is_named_alone(name, said):
    found = diagnosed(**{name: said})
    assert [effect.name for effect in found.effects] == [name]
    assert (
        found.verdict == "explained" and "by the profile" in found.effects[0].sentence
    )
    profile = json.loads(found.profile_json)
    written = next(e for e in profile["effects"] if e["name"] == name)["parameters"]
    for parameter, truth in PATTERNS[name].items():
        assert written[parameter] == pytest.approx(truth, rel=0.2), parameter
    assert [rung.action for rung in found.ladder] == ["contradicted"]
    assert "not as strong as the profile planted says" in verdict_sentence(found)
    assert found.gap.after < found.gap.before


@pytest.mark.slow
def test_a_name_that_is_left_out_is_not_given():
    found = diagnosed(without=["prnu"], prnu={"sigma": 0.006})
    assert found.effects == []


def of_darks(sensor, truth, count=4):
    """Return a function that draws two groups of darks with a map of (1, H, W)."""
    captures = [
        planted_capture("dark", n, name=f"d{n}{group}", group=group)
        for group in ("fit", "select")
        for n in range(count)
    ]
    return lambda pixels: drawn(planted_frames(sensor, captures), truth, 5, pixels)


def mapped(sensor, name, stated, splits, **more):
    """Return the model of a profile with its map of the fit frames."""
    model = model_of(sensor, **{name: [stated]}, **more)
    term = replace(model.term(name), calibration=True)
    return fit_patterns(model.with_term(term), splits.fit)


def says(**effects):
    """Return a sensor whose profile says how strong some patterns are."""
    return made(
        effects=[
            {"name": name, "parameters": {"sigma": sigma}}
            for name, sigma in effects.items()
        ]
    )


@pytest.mark.parametrize("divided", [True, False])
def test_columns_are_not_asked_where_all_splits_have_the_same(divided):
    """Frames that are divided by pixels have what their columns share in all splits."""
    stated = 0.1 * READ
    sensor = says(column_fixed_pattern=stated)
    columns = READ * np.random.default_rng(4).standard_normal((1, 1, FRAME[1]))
    frames = of_darks(sensor, Model(made()))(columns)
    if divided:
        shots = [frame.capture.raw for frame in frames[:4]] * 2
        frames = [
            replace(frame, capture=replace(frame.capture, raw=raw))
            for frame, raw in zip(frames, shots, strict=True)
        ]
    splits = Splits(frames, ONE)
    model = mapped(sensor, "column_fixed_pattern", stated, splits)
    found = contradicted(model, splits)
    assert list(found) == ([] if divided else ["column_fixed_pattern"])


@pytest.mark.parametrize("noise", [1.0, 1.3])
def test_noise_that_a_profile_lacks_is_no_pattern(noise):
    """Maps of both splits are as much stronger by it, and have no more in common."""
    stated = 0.5 * READ
    sensor = says(dsnu=stated)
    truth = model_of(sensor, read_noise=[np.log(noise)])
    pixels = stated * np.random.default_rng(6).standard_normal((1, *FRAME))
    splits = Splits(of_darks(sensor, truth, 2)(pixels), ONE)
    model = mapped(sensor, "dsnu", stated, splits)
    given_up = model.term("dsnu").contradicted
    assert (given_up > 10) == (noise > 1)
    assert contradicted(model, splits).get("dsnu", 0.0) < min(given_up + 1, 5)


@pytest.mark.parametrize("blend", [0.0, 0.1])
def test_frames_that_were_blended_are_not_asked(blend):
    stated, strength = 0.2 * READ, READ
    sensor = says(dsnu=stated)
    pixels = strength * np.random.default_rng(8).standard_normal((1, *FRAME))
    splits = Splits(of_darks(sensor, Model(made()))(pixels), ONE)
    more = {"noise_reduction": [blend, 0.0]} if blend else {}
    model = mapped(sensor, "dsnu", stated, splits, **more)
    assert model.term("dsnu").contradicted > 10
    assert list(contradicted(model, splits)) == ([] if blend else ["dsnu"])
