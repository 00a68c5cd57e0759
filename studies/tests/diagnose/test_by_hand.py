# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Figures by hand: known of frames that NumPy draws, and of the real ones where they
are."""

import json
import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy")

from studies.diagnose import by_hand
from studies.diagnose.real_frames import VARIABLE, ccd

SIDE = 192
TRUTH = {
    "black_level": 500.0,
    "read_noise": 6.0,
    "row_noise": 1.0,
    "correlation": -0.08,
    "column_fixed_pattern": 1.0,
    "dsnu": 3.0,
    "dark_current": 0.5,
    "hot_pixels": 0.01,
    "gain": 2.0,
    "prnu": 0.02,
}


@pytest.fixture(scope="module")
def frames():
    """Return 36 frames of the CCD's plan, with every figure planted."""
    rng = np.random.default_rng(8)
    shape = (SIDE, SIDE)
    offset = TRUTH["dsnu"] * rng.standard_normal(shape)
    offset += TRUTH["column_fixed_pattern"] * rng.standard_normal(SIDE)
    response = 1 + TRUTH["prnu"] * rng.standard_normal(shape)
    leak = np.where(rng.random(shape) < TRUTH["hot_pixels"], 20.0, 0.0)
    leak += TRUTH["dark_current"]

    def frame(kind, seconds):
        light = 18000 * response if kind == "flat" else 0.0
        charge = rng.poisson(TRUTH["gain"] * (light + leak * seconds))
        white = np.sqrt(TRUTH["read_noise"] ** 2 - TRUTH["row_noise"] ** 2)
        noise = rng.standard_normal((SIDE, SIDE + 1))
        side = TRUTH["correlation"]  # a moving average of two
        noise = (noise[:, 1:] + side * noise[:, :-1]) / np.hypot(1, side)
        rows = TRUTH["row_noise"] * rng.standard_normal((SIDE, 1))
        level = TRUTH["black_level"] + 0.3 * rng.standard_normal()
        dn = level + charge / TRUTH["gain"] + white * noise + rows + offset
        return np.rint(dn).astype(np.uint16)

    plan = [("dark", 0.0)] * 10 + [("dark", 60.0)] * 10 + [("flat", 23.0)] * 10
    plan += [("dark", seconds) for seconds in (10.0, 30.0, 100.0, 150.0, 200.0, 300.0)]
    shots = [SimpleNamespace(frame=frame(*p), kind=p[0], seconds=p[1]) for p in plan]
    return by_hand.Frames(shots)


def test_planted_figures_are_found_within_their_errors(frames):
    found = by_hand.table(frames)
    for name, truth in TRUTH.items():
        value, error = found[name]["value"], found[name]["error"]
        # Patterns are drawn: their sd differs from the law's by a share of this.
        drawn = {"column_fixed_pattern": (2 * SIDE) ** -0.5}.get(name, 0.004) * truth
        assert abs(value - truth) < 4 * np.hypot(error, drawn), (name, value, error)
        assert 0 < error < 0.12 * abs(truth), (name, error)
    assert found["drift"]["value"] == pytest.approx(0.3, abs=0.2)


def test_the_reference_has_all_figures_and_their_definitions():
    said = json.loads(by_hand.FILE.read_text())
    assert list(said) == [figure.__name__ for figure, _ in by_hand.FIGURES]
    assert all(
        len(one["definition"]) > 20 and one["error"] > 0 for one in said.values()
    )


@pytest.mark.slow
@pytest.mark.skipif(VARIABLE not in os.environ, reason=f"no {VARIABLE}: real frames")
def test_the_reference_is_what_the_real_frames_give():
    found = by_hand.table(by_hand.Frames(ccd(Path(os.environ[VARIABLE]))))
    for name, one in json.loads(by_hand.FILE.read_text()).items():
        assert found[name]["value"] == pytest.approx(one["value"], rel=1e-9)


def test_without_frames_it_says_so(monkeypatch, capsys):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr("sys.argv", ["ccd-by-hand"])
    assert by_hand.main() == 1
    assert capsys.readouterr().err == (
        f"ccd-by-hand: no folder of real frames: give one by --data or {VARIABLE}\n"
    )
