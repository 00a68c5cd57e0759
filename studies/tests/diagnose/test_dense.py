# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dense cameras: all effects in the truth, few of them wrong in the profile."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy")

import cg2raw
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.synthetic.strengths import KINDS
from diagnose.closed_loop import scene_of
from studies.diagnose.dense import OF_NOISE, WRONG, DenseCase, dense_names, draw_faults
from studies.diagnose.dense_strengths import DRAWS, SHAPES, Unit, draw_dense
from studies.diagnose.scores import bounds, errors
from studies.diagnose.suites import cases

UNIT = Unit(read_noise=4e-4, electron=1e-4)
REGISTRY = {effect["name"]: effect for effect in cg2raw.effects()}


def effects_of(sensor):
    return {effect["name"]: effect["parameters"] for effect in sensor.effects}


@pytest.mark.parametrize("name", [n for n in dense_names() if n in REGISTRY])
def test_strengths_are_within_the_registry_and_not_null(name):
    known = REGISTRY[name]["parameters"]
    if {p["name"] for p in known} <= {"beta1_00", "beta1_01", "beta1_10", "beta1_11"}:
        return  # of the noise table alone
    for seed in range(20):
        drawn = draw_dense(name, np.random.default_rng(seed), known, UNIT)
        strong = [drawn[p["name"]] != p["null"] for p in known if p["name"] in drawn]
        assert any(strong) or name in ("heavy_tailed_noise", "poisson_shot_noise")
        for p in known:
            if p["name"] in drawn:
                assert p["min"] <= drawn[p["name"]] <= p["max"]


def test_an_effect_without_a_line_takes_a_share_of_its_bounds():
    known = [
        {"name": "size", "min": 0.0, "max": 2.0, "null": 0.0},
        {"name": "tilt", "min": -1.0, "max": 1.0, "null": 0.0},
    ]
    drawn = [
        draw_dense("no_such", np.random.default_rng(n), known, UNIT) for n in range(50)
    ]
    sizes, tilts = (np.array([d[k] for d in drawn]) for k in ("size", "tilt"))
    assert 0.002 <= sizes.min() < 0.004 and 0.01 < sizes.max() <= 0.02
    assert (np.abs(tilts) <= 0.01).all() and tilts.min() < 0 < tilts.max()


def test_every_draw_has_a_range():
    assert set(DRAWS) <= set(KINDS)


@pytest.mark.parametrize("suite", WRONG)
def test_the_profile_is_wrong_in_what_is_hidden_and_in_nothing_else(suite):
    for seed in range(6):
        faults = draw_faults(seed, dense_names(), WRONG[suite])
        case = DenseCase(suite, 0, seed, faults)
        true, doubted = case.sensor({}), case.sensor(case.strengths)
        ours, theirs = effects_of(true), effects_of(doubted)
        wrong = {name for name in ours if theirs.get(name) != ours[name]}
        names = {"beta1": "shot_noise", "beta2": "read_noise"}
        rows = true.noise[0], doubted.noise[0]
        wrong |= {names[key] for key in names if rows[0][key] != rows[1][key]}
        drawn = set(true.noise_effects) ^ set(doubted.noise_effects)
        wrong |= drawn & {"poisson_shot_noise", "heavy_tailed_noise"}
        if rows[0].get("outlier_fraction") != rows[1].get("outlier_fraction"):
            wrong.add("heavy_tailed_noise")
        assert len(faults) == WRONG[suite] and wrong == set(faults)


def test_a_dense_camera_has_all_names():
    sensor = DenseCase("dense-1", 0, 5, {}).sensor({})
    has = set(effects_of(sensor)) | set(sensor.noise_effects)
    assert has | {"read_noise", "shot_noise"} >= set(dense_names())


def test_what_is_expected_makes_the_doubted_profile_true():
    faults = {"lens_shading": 2.0, "exposure": 0.0, "read_noise": 1.3, "prnu": 0.0}
    case = DenseCase("dense-5", 0, 9, faults)
    true, doubted = (effects_of(case.sensor(f)) for f in ({}, faults))
    wanted = case.expected()
    for name in ("lens_shading", "exposure", "prnu"):
        had = doubted.get(name, dict.fromkeys(true[name], 0.0))
        for key, value in wanted[name].items():
            assert had[key] + value == pytest.approx(true[name][key])
    assert wanted["read_noise"] == {"log_variance": pytest.approx(-np.log(1.3))}


def test_factors_leave_shapes_and_what_is_only_stated():
    faults = [draw_faults(seed, dense_names(), 5) for seed in range(60)]
    fixed = {e.name for e in candidates("RGGB") if not e.of_mean} - OF_NOISE
    assert {f[n] for f in faults for n in fixed & set(f)} == {0.0}
    case = DenseCase("dense-1", 0, 3, {"blur": 2.0})
    true, doubted = (effects_of(case.sensor(f))["blur"] for f in ({}, case.strengths))
    assert all(true[k] == doubted[k] for k in SHAPES & set(true))
    assert doubted["ring_1"] == pytest.approx(2 * true["ring_1"])


def test_frames_are_of_the_true_sensor_and_repeat_each_other():
    case = DenseCase("dense-1", 0, 13, {"exposure": 0.0})
    found, hidden = case.captures()
    assert set(hidden) == {"exposure"} and "exposure" not in effects_of(found.sensor)
    for group in ("fit", "select", "report"):
        ours = [c for c in found.captures if c.group == group and c.kind == "dark"]
        times = [capture.exposure_time for capture in ours]
        assert len(times) == 4 and len(set(times)) == 2
    flat, again = [c for c in found.captures if c.name.startswith("fit_flat_1")]
    assert not np.array_equal(flat.raw(), again.raw())
    run = {"iso": flat.iso, "exposure_time": flat.exposure_time, "threads": 1}
    run |= {"illuminant": flat.illuminant, "convention": "sensor"}
    off = []
    for sensor in (case.sensor({}), found.sensor):
        mean = sensor.predict(scene_of(flat), **run)[0]
        measured = sensor.signal_from_raw(flat.raw())
        open_ = mean < 0.9 * mean.max()
        off.append(abs((measured - mean)[open_].mean() / mean[open_].mean()))
    gain = abs(hidden["exposure"]["gain"])
    assert off[1] == pytest.approx(gain, abs=0.5 * gain) and off[0] < 0.5 * gain


@pytest.mark.slow
def test_evidence_is_large_for_what_is_seen_by_anybody():
    case = DenseCase("dense-1", 0, 12, {"exposure": 0.0})
    assert case.truth["exposure"]["gain"] > 0.05
    assert case.evidence(["exposure"])["exposure"] > 100
    right = DenseCase("dense-1", 0, 12, {"exposure": 1.0})
    assert right.evidence(["exposure"])["exposure"] == pytest.approx(0, abs=1e-6)


def test_values_of_right_names_are_compared_with_the_truth():
    def estimate(value, low, high):
        return SimpleNamespace(value=value, ci95=(low, high))

    parameters = {"sigma": estimate(0.014, 0.01, 0.02)}
    effects = [
        SimpleNamespace(name="prnu", parameters=parameters),
        SimpleNamespace(name="blur", parameters={"ring_1": estimate(0.5, 0, 1)}),
    ]
    found = SimpleNamespace(effects=effects)
    off = {
        truth: errors({"prnu": {"sigma": truth}, "dsnu": {"sigma": 1.0}}, found)
        for truth in (0.02, 0.012)
    }
    assert off[0.02] == {"prnu.sigma": pytest.approx(-1.96, abs=1e-3)}
    assert off[0.012] == {"prnu.sigma": pytest.approx(0.98, abs=1e-3)}


def test_a_set_is_exact_but_for_what_nobody_could_see():
    def record(named, evidence, off):
        extra = len(set(named) - {"prnu", "blur"})
        return {
            "named": named,
            "extra": extra,
            "exact": sorted(named) == ["blur", "prnu"],
            "evidence": evidence,
            "nats_needed": 7.8,
            "errors": off,
            "closed": 1.0,
        }

    records = [
        record(["prnu", "blur"], {}, {"prnu.sigma": 1.0}),
        record(["prnu"], {"blur": 3.0}, {"prnu.sigma": 3.0}),
        record(["prnu"], {"blur": 30.0}, {}),
        record(["prnu", "dsnu"], {"blur": 3.0}, {}),
    ]
    values = [value for _, value, _ in bounds("dense-3", records)]
    assert values[:4] == [0.5, 0.25, 1 / 6, 0.5]


@pytest.mark.slow
@pytest.mark.parametrize("faults", [{}, {"amplifier_glow": 0.5}])
def test_a_dense_profile_is_contradicted_where_it_is_wrong(faults):
    [case] = cases("dense-1", 77, 1)
    found = diagnose(replace(case, strengths=faults).captures()[0], details=False)
    assert [effect.name for effect in found.effects] == list(faults)
    assert faults or found.gap.chi2_after == pytest.approx(1, abs=0.01)
