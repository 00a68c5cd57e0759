# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""diagnose() as a whole, on small sets."""

import time
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.diagnosis import Diagnosis
from cg2raw.diagnose.pipeline import diagnose
from cg2raw.diagnose.scenes.decide import Scenes
from cg2raw.diagnose.workers import TimeIsUp, Workers
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.conditions import STUDIO
from cg2raw.synthetic.sensors import ISO, drawn_sensor, with_noise
from diagnose.planted import (
    bare,
    capture_of,
    changed,
    model_of,
    sensor_of,
    shown_set,
    standard_set,
    x_trans,
)
from tiers import slow

SENSOR = sensor_of()
SHAPE = (64, 84)  # of whole repeats of X-Trans too
FEW = ("exposure", "read_noise", "black_level", "gr_gb_imbalance")


def set_of(sensor, seed=1, extra=0.0, shape=SHAPE, model=None, **more):
    """Return the standard set, whose pixels a model draws."""
    return shown_set(sensor, standard_set(shape, **more), seed, extra, model)


def run(captures, **more):
    return diagnose(captures, **{"only": FEW, "details": False, "threads": 1, **more})


def summary(found):
    """Return all of a verdict that could depend on how it was computed."""
    effects = [
        (e.name, e.gain_nats, {n: p.value for n, p in e.parameters.items()})
        for e in found.effects
    ]
    tests = [(t.name, t.p_value) for t in found.tests_after]
    return found.verdict, effects, tests, found.gap, found.profile_json


def few_scenes(
    seed, number="01", repeats="01", kinds=("scene",), nuisances=None, **hidden
):
    """Return scenes of each split by their number and frames by theirs, of a camera,
    and all captures of other kinds."""
    sensor = drawn_sensor(seed + 100)
    hidden = draw_hidden(sensor, hidden, seed=seed)
    made = simulate_captures(sensor, hidden, seed=seed, twice=True, nuisances=nuisances)
    kept = [
        c
        for c in made.captures
        if c.kind in kinds
        if c.kind != "scene"
        or (c.name.split("_")[2] in number and c.name.split("_")[3] in repeats)
    ]
    return replace(made, captures=kept)


@pytest.mark.parametrize(("seed", "number"), [(19, "0"), (1, "01")])
def test_scenes_alone_say_no_more_of_noise_than_they_know(seed, number):
    """Few samples tell noise to 2 %, and read noise beside light hardly at all: frames
    of other light differ by more than their own error from what was fitted."""
    found = diagnose(few_scenes(seed, number), details=False)
    assert (found.verdict, found.unexplained) == ("consistent", [])


def test_noise_is_the_profile_s_again_where_a_gap_that_looked_like_it_closes():
    """At first, 10 % less light looks like seven times its noise and no read noise."""
    found = diagnose(few_scenes(11, "0", "0", exposure=0.1), details=False)
    assert (found.verdict, found.unexplained) == ("explained", [])
    assert [one.name for one in found.effects] == ["exposure"]


def test_a_strong_blur_is_found_by_steps_that_are_as_linear_as_they_seem():
    """Its red is wider than its green, of which a linear model knows nothing yet: seven
    others would take that up, by stops of exposure that other gains undo."""
    found = diagnose(few_scenes(3, blur=1.5), details=False)
    assert [one.name for one in found.effects] == ["blur"]
    assert found.verdict == "explained"
    assert found.effects[0].parameters["red_scale"].ci95[0] > 0.1
    assert found.gap.chi2_after < 1.2 < 10 < found.gap.chi2_before


@pytest.mark.parametrize(
    ("name", "strength", "kinds", "others"),
    [
        ("bias_structure", 0.8, {"scene"}, {"amplifier_mismatch"}),
        ("bias_structure", 0.8, {"scene", "flat"}, {"amplifier_mismatch"}),
        ("amplifier_mismatch", 0.3, {"scene"}, set()),
        ("noise_reduction", 0.1, {"scene"}, {"blur"}),
        ("black_level", 0.5, {"scene"}, set()),
    ],
)
def test_what_darks_would_show_is_none_of_the_lens(name, strength, kinds, others):
    """Without darks, or without flats, scenes decide, or what is named in its place is
    ambiguous with it."""
    captures = few_scenes(3, kinds=kinds, **{name: strength})
    found = diagnose(captures, details=False)
    effects = {one.name: set(one.ambiguous_with) for one in found.effects}
    assert effects.keys() <= {name, *others}
    assert all(name in {one, *alike} for one, alike in effects.items())
    assert found.effects and not found.unexplained


def test_noise_reduction_is_no_blur_where_renders_are_off_as_well():
    hidden = {"noise_reduction": 0.055, "nuisances": STUDIO}
    found = diagnose(few_scenes(3, **hidden), details=False)
    assert [one.name for one in found.effects] == ["noise_reduction"]


def test_a_black_level_beside_amplifiers_may_be_first_columns_of_their_own():
    """Of which images are not fitted."""
    hidden = {"amplifier_mismatch": 0.3, "bias_structure": 0.6}
    found = diagnose(few_scenes(3, **hidden), details=False)
    effects = {one.name: one.ambiguous_with for one in found.effects}
    assert effects["amplifier_mismatch"] == []
    assert "bias_structure" in effects["black_level"]


def test_a_black_level_on_which_scenes_do_not_agree_may_be_drift():
    found = diagnose(few_scenes(2, black_level_drift=0.2), details=False)
    effects = {one.name: one.ambiguous_with for one in found.effects}
    assert effects == {"black_level": ["dark_current", "black_level_drift"]}


@pytest.mark.parametrize(
    ("seed", "strength", "others"),
    [
        (4, 10.0, []),
        (4, 2.0, ["amplifier_glow"]),
        (7, 2.0, ["black_level", "amplifier_glow"]),
    ],
)
def test_dark_current_grows_with_the_time_of_scenes(seed, strength, others):
    """A black level does not; what is weak may be either, or glow, of which a ramp
    would be weaker still."""
    found = diagnose(few_scenes(seed, dark_current=strength), details=False)
    [one] = found.effects
    assert (one.name, one.ambiguous_with) == ("dark_current", others)


def test_a_ramp_that_no_darks_tell_may_be_glow():
    """And the dark current that is named with it, the mean of that."""
    found = diagnose(few_scenes(8, amplifier_glow=60.0), details=False)
    assert {one.name: one.ambiguous_with for one in found.effects} == {
        "bias_structure": ["amplifier_glow"],
        "dark_current": ["amplifier_glow"],
    }


def test_darks_whose_noise_lies_within_a_code_have_no_part_in_it():
    """At 0.2 DN about a whole code one pixel in 80 has another: patterns were named."""
    made = changed(drawn_sensor(5), bits=10, white_level=1023, black_level=[4.0] * 4)
    sensor = with_noise(made, 3 * 1019 / 0.2, 3.0, ISO)
    found = diagnose(simulate_captures(sensor, {}, seed=4, twice=True), details=False)
    assert (found.verdict, found.effects) == ("consistent", [])
    assert found.groups["fit"] == [
        *("fit_flat_0", "fit_flat_0_again", "fit_flat_1", "fit_flat_1_again"),
        *("fit_scene_0_0", "fit_scene_0_1", "fit_scene_1_0", "fit_scene_1_1"),
    ]
    assert [note.split(":")[0] for note in found.notes] == ["Darks are left out"]


def test_nothing_hidden_is_no_gap():
    found = run(set_of(SENSOR), only=())
    assert (found.verdict, found.effects) == ("consistent", [])
    assert found.gap.chi2_after == pytest.approx(1, abs=0.03)
    assert {p.name for p in found.detection_limits} > {"exposure", "lens_shading"}


def test_the_verdict_does_not_depend_on_threads():
    true = model_of(SENSOR, exposure=[0.03], read_noise=[0.4])
    captures = set_of(SENSOR, model=true, exposure_time=1.0)
    one, three = (summary(run(captures, threads=n)) for n in (1, 3))
    assert one == three
    assert one[0] == "explained"
    assert sorted(name for name, _, _ in one[1]) == ["exposure", "read_noise"]
    values = {name: list(parameters.values()) for name, _, parameters in one[1]}
    assert values["exposure"][0] == pytest.approx(0.03, abs=0.002)
    assert values["read_noise"][0] == pytest.approx(0.4, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "strength", "value"),
    [
        ("row_noise", 0.3, 0.3 * 5 / 10000),
        ("column_fixed_pattern", 0.3, 0.3 * 5 / 10000),
        ("dark_current", 2.0, 2 / 10000),
    ],
)
def test_noise_that_is_cut_at_zero_hides_no_effect(name, strength, value):
    """A camera without a pedestal shows half of a dark's noise: of 5 in 10000 e-. Of
    one plane: tests/diagnose/test_mono.py."""
    sensor = with_noise(Sensor("nikon-d40"), 10000, 5, ISO)
    assert sensor.black_level == [0.0] * 4
    hidden = draw_hidden(sensor, {name: strength}, seed=1)
    captures = simulate_captures(sensor, hidden, seed=1, shape=(64, 96))
    found = diagnose(captures, details=False, threads=2)
    assert found.verdict == "explained"
    (effect,) = found.effects
    (parameter,) = effect.parameters.values()
    assert effect.name == name
    assert parameter.value == pytest.approx(value, rel=0.15)
    assert found.gap.chi2_after == pytest.approx(1, abs=0.015)


@pytest.mark.parametrize("passes", [0, 1])
def test_an_interrupt_still_reports(monkeypatch, passes):
    captures = set_of(SENSOR, model=model_of(SENSOR, exposure=[0.05]))
    done = []
    once = Scenes._pass

    def interrupted(self):
        if len(done) == passes:
            raise KeyboardInterrupt
        done.append(1)
        return once(self)

    monkeypatch.setattr(Scenes, "_pass", interrupted)
    found = run(captures)
    assert isinstance(found, Diagnosis) and found.interrupted
    assert found.verdict == "incomplete"
    assert len(found.effects) == passes
    if not passes:
        assert found.gap.chi2_before == found.gap.chi2_after > 1.05


@pytest.mark.parametrize(
    ("last_dark", "of"), [("none", "images"), slow("0", "captures")]
)
def test_x_trans_goes_through_with_nothing_hidden(last_dark, of):
    """Its noise is not known: that is fitted, and named by nobody. One flat a group and
    none or one dark, of 36 planes each."""
    made = set_of(x_trans(), shape=(96, 108)).captures
    last = {"dark": last_dark, "flat": "1", "scene": "01"}
    captures = [c for c in made if c.name[-1] in last[c.kind]]
    captures = CaptureSet(bare(x_trans()), captures)
    found = diagnose(captures, only=("exposure", "lens_shading"), threads=1)
    assert found.effects == []
    assert any(f"fitted to the {of}" in note for note in found.notes)
    assert Sensor.from_json(found.profile_json, "found").noise


@pytest.mark.slow
def test_frames_without_noise_are_said_to_be():
    found = diagnose(set_of(bare(SENSOR)), only=("exposure",), threads=1)
    assert any("noise lies within a code" in note for note in found.notes)


@pytest.mark.slow
def test_x_trans_of_known_noise_is_consistent():
    found = diagnose(set_of(x_trans(), shape=(192, 216)), details=True, threads=1)
    assert (found.verdict, found.effects) == ("consistent", [])


def test_frames_without_exposure_time_name_no_rates():
    found = run(set_of(SENSOR, exposure_time=None), only=("dark_current", "exposure"))
    assert found.verdict == "consistent"
    visible = {limit.name: limit.strength for limit in found.detection_limits}
    assert visible["exposure"] > 0 and visible["dark_current"] is None


def test_masked_borders_are_darks_of_another_shape():
    """They come first, have their own shape, and an offset shows in them alone."""
    scenes = set_of(SENSOR).captures
    borders = [
        capture_of("dark", 90 + n, shape=(64, 20), group=group, name=f"border {group}")
        for n, group in enumerate(GROUPS)
    ]
    offset = model_of(SENSOR, black_level=[2e-4, 2e-4, 2e-4, 2e-4])
    narrow = shown_set(SENSOR, borders, 3, model=offset).captures
    bright = [c for c in scenes if c.kind != "dark"]
    wide = shown_set(SENSOR, bright, 4, model=offset).captures
    found = run(CaptureSet(SENSOR, [*narrow, *wide]))
    assert [e.name for e in found.effects] == ["black_level"]
    assert found.verdict == "explained"
    prnu = run(CaptureSet(SENSOR, [*narrow, *wide]), only=("prnu", "dsnu"))
    assert prnu.effects == []


def test_isos_have_their_own_noise_and_share_what_is_missing():
    table = [
        {"iso": iso, "beta1": [gain * 2e-4] * 4, "beta2": [gain * 4e-7] * 4}
        for iso, gain in ((100, 1), (800, 8))
    ]
    sensor = changed(SENSOR, noise=table)
    low, high = (set_of(sensor, seed=n, iso=iso) for n, iso in ((1, 100.0), (2, 800.0)))
    renamed = [replace(c, name=c.name + "h", set=c.set + "h") for c in high.captures]
    found = run(CaptureSet(sensor, [*low.captures, *renamed]))
    assert found.verdict == "consistent"


def test_a_profile_with_effects_is_the_base():
    old = {"r2": -0.3, "r4": -0.1, "r6": 0.0, "tilt_x": 0.02, "tilt_y": 0.0}
    old |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
    shaded = sensor_of(effects={"lens_shading": old})
    captures = set_of(shaded)
    only = {"only": ("lens_shading", "exposure")}
    assert run(captures, **only).verdict == "consistent"
    doubted = run(CaptureSet(SENSOR, captures.captures), **only)
    assert [e.name for e in doubted.effects] == ["lens_shading"]
    repaired = Sensor.from_json(doubted.profile_json, "found")
    again = run(CaptureSet(repaired, captures.captures), **only)
    assert (again.verdict, again.effects) == ("consistent", [])


@pytest.mark.parametrize("name", ["prnu", "dsnu"])
def test_a_profile_with_a_pattern_does_not_know_the_camera_s_map(name):
    sigma = {"prnu": 0.01, "dsnu": 5e-4}[name]
    sensor = sensor_of(effects={name: {"sigma": sigma}})
    pattern = sigma * np.random.default_rng(8).standard_normal((1, *SHAPE))

    def exposed(frame, rng):
        light = frame.camera.transpose(0, 2, 3, 1)
        at = np.take_along_axis(light, frame.color[None, :, :, None], 3)[..., 0]
        return pattern * (at if name == "prnu" else 1.0)

    captures = set_of(sensor_of(), extra=exposed)
    found = run(CaptureSet(sensor, captures.captures), only=("prnu", "dsnu"))
    assert (found.verdict, found.effects) == ("consistent", [])
    (effect,) = Sensor.from_json(found.profile_json, "found").effects
    assert effect["parameters"]["sigma"] == pytest.approx(sigma)


def test_flats_of_unknown_level_show_what_does_not_need_one():
    captures = set_of(SENSOR, model=model_of(SENSOR, gr_gb_imbalance=[0.01, -0.01]))
    free = [
        replace(c, scene=None) if c.kind == "flat" else c for c in captures.captures
    ]
    found = run(CaptureSet(SENSOR, [c for c in free if c.kind != "scene"]))
    assert [e.name for e in found.effects] == ["gr_gb_imbalance"]


def test_a_large_frame_is_worked_on_in_tiles():
    captures = set_of(SENSOR, shape=(140, 184), model=model_of(SENSOR, exposure=[0.02]))
    given = {"pixels": 8192, "only": ("exposure", "read_noise")}
    found = run(captures, **given, details=True)
    assert [e.name for e in found.effects] == ["exposure"]
    assert found.gap.chi2_after == pytest.approx(1, abs=0.02)
    again = run(captures, **given)
    assert summary(again) == summary(found)


def test_a_chance_of_none_is_refused():
    with pytest.raises(ValueError, match="alpha 0 must lie between 0 and 1"):
        run(set_of(SENSOR), alpha=0)


@pytest.mark.parametrize(
    ("hidden", "other"),
    [
        ({"noise_reduction": 0.2}, {"noise_reduction"}),
        slow({"shot_noise": 0.5}, set()),
    ],
    ids=["less noise", "more noise"],
)
def test_without_repeats_less_noise_may_be_noise_reduction(hidden, other):
    sensor = drawn_sensor(5)
    hidden = draw_hidden(sensor, hidden, seed=5)
    made = simulate_captures(sensor, hidden, seed=5, shape=(64, 96))
    found = diagnose(made, details=False, threads=1)
    effects = {one.name: set(one.ambiguous_with) for one in found.effects}
    assert effects.pop("noise_reduction", set()) == set()  # scenes show what it softens
    assert "shot_noise" in effects
    assert all(alike - {"heavy_tailed_noise"} == other for alike in effects.values())
    assert any("two flats" in text for text in found.next_captures) == bool(other)


@pytest.mark.parametrize("count", [1, 2])
def test_workers_begin_nothing_after_the_deadline(count):
    words = ["b", "a", "c"]
    for deadline in (None, time.monotonic() + 600):
        assert Workers(count, deadline).map(str.upper, words) == ["B", "A", "C"]
    with pytest.raises(TimeIsUp):
        Workers(count, time.monotonic() - 1).map(str.upper, words)
