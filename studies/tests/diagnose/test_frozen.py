# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The frozen suites: their files are what the generator makes, to the last pixel."""

import json
import os
from collections import Counter
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from cg2raw.synthetic.strengths import KINDS, UNKNOWN_KINDS
from cg2raw.synthetic.synthetic_camera import GROUPS
from studies.diagnose import frozen
from studies.diagnose.cameras import manifest
from studies.diagnose.real_frames import VARIABLE
from studies.diagnose.suites import TEN
from tiers import first_fast

SYNTHETIC = [suite for suite in frozen.SIZES if suite != "real"]
SEALS = json.loads(frozen.SEALS.read_text())
WITHIN_A_SECOND = ("nine", "nuisance-none")


def check_alike(said, drawn):
    """Strengths may differ in their last digit: numpy's exp does from processor to
    processor (with AVX-512, without)."""
    each = [
        [replace(case, strengths=dict.fromkeys(case.strengths)) for case in cases]
        for cases in (said, drawn)
    ]
    assert each[0] == each[1]
    for one, other in zip(said, drawn, strict=True):
        assert one.strengths == pytest.approx(other.strengths, rel=1e-12)


@pytest.mark.parametrize("suite", SYNTHETIC)
def test_a_file_says_what_the_generator_draws(suite):
    said = frozen.frozen(suite)
    assert len(said) == frozen.SIZES[suite]
    check_alike(said, frozen.drawn(suite))
    lines = (frozen.FOLDER / f"{suite}.csv").read_text().splitlines()[1:]
    assert lines == [",".join(frozen.row(case).values()) for case in said]


@pytest.mark.skipif(VARIABLE not in os.environ, reason=f"no {VARIABLE}: real frames")
def test_the_file_of_real_frames_says_what_is_planted():
    path = manifest("ccd", Path(os.environ[VARIABLE]))
    said = frozen.frozen("real", path)
    assert len(said) == 100
    check_alike(said, frozen.drawn("real", path))


@pytest.mark.parametrize("suite", first_fast(SYNTHETIC, 1))
def test_each_split_has_two_frames_of_each_time_level_and_scene(suite):
    found, _ = frozen.frozen(suite)[-1].captures()
    seen = Counter((c.group, c.kind, c.set, c.exposure_time) for c in found.captures)
    groups = Counter((group, kind) for group, kind, *_ in seen)
    assert set(seen.values()) == {2}
    assert groups == dict.fromkeys(product(GROUPS, ("dark", "flat", "scene")), 2)
    assert len({c.raw().tobytes() for c in found.captures}) == 36


@pytest.mark.parametrize(
    "suite",
    [
        pytest.param(suite, marks=() if suite in WITHIN_A_SECOND else pytest.mark.slow)
        for suite in SYNTHETIC
    ],
)
def test_frames_are_those_that_were_sealed(suite):
    sets = frozen.frozen(suite)[: frozen.SEALED.get(suite, 1)]
    assert frozen.seal(sets) == SEALS[suite]


def test_another_strength_breaks_the_seal():
    first = frozen.frozen("pairs")[0]
    name, strength = next(iter(first.strengths.items()))
    other = replace(first, strengths=first.strengths | {name: 1.001 * strength})
    assert frozen.seal([other]) != SEALS["pairs"]


def test_every_effect_is_hidden_as_often_and_the_first_sets_have_all():
    hidden = [*(list(case.strengths) for case in frozen.frozen("single"))]
    assert sorted(sum(hidden[: frozen.SEALED["single"]], [])) == sorted(KINDS)
    assert sorted(sum(hidden, [])) == sorted(list(KINDS) * 20)
    hidden = [set(case.strengths) for case in frozen.frozen("nine")]
    left_out = [set(TEN) - names for names in hidden]
    assert [len(names) for names in left_out] == [1] * 60
    assert all(left_out.count({name}) == 6 for name in TEN)
    outside = [*(list(case.strengths) for case in frozen.frozen("unknown"))]
    assert set(sum(outside[: frozen.SEALED["unknown"]], [])) == set(UNKNOWN_KINDS)
    counts = Counter(sum(outside, []))
    assert counts.keys() == UNKNOWN_KINDS.keys() and set(counts.values()) == {14, 15}


def test_low_noise_is_below_half_a_code_or_cut_at_0():
    for case in frozen.frozen("low-none")[:40]:
        sensor, _ = case.sensor_and_hidden()
        reach = sensor.white_level - sensor.black_level[0]
        noise = sensor.noise[0]["beta2"][0] ** 0.5 * reach
        assert sensor.black_level[0] == 0 or noise < 0.5
        assert 0.19 < noise < 2.01


def test_a_bad_line_is_named(tmp_path, monkeypatch):
    (tmp_path / "none.csv").write_text("number,seed,decided_by,hidden\n0,x,,\n")
    monkeypatch.setattr(frozen, "FOLDER", tmp_path)
    with pytest.raises(ValueError, match=r"none\.csv:2: invalid literal"):
        frozen.frozen("none")
