# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Real frames as they are: what the file says, and captures that are made of it."""

import json
import math

import numpy as np
import pytest

pytest.importorskip("scipy")

from cg2raw.diagnose.effects.catalogue import names
from studies.diagnose import cameras as module
from studies.diagnose import run as command
from studies.diagnose.cameras import cameras, in_registry, sets
from studies.diagnose.real_frames import VARIABLE


def test_the_file_has_known_names_and_a_profile_or_a_chart():
    for name, said in sets().items():
        assert set(said["names"]) <= set(names()), name
        assert said["names"] and ("profile" in said) != ("chart" in said)
        assert said.get("calibrated_by", "ccd") in sets()


def test_values_by_hand_are_in_the_units_of_the_registry():
    profile = {"bits": 12, "black": 95, "read_noise": 2.0, "electrons_per_dn": 3.0}
    values = {"read_noise": 4.0, "gain": 1.5, "drift": 0.4, "prnu": 0.01}
    assert in_registry(values, profile) == {
        "black_level_drift": {"sigma": pytest.approx(1e-4)},
        "read_noise": {"log_variance": pytest.approx(math.log(4))},
        "shot_noise": {"log_gain": pytest.approx(math.log(2))},
        "prnu": {"sigma": 0.01},
    }


@pytest.fixture
def data(tmp_path, monkeypatch):
    """Return a folder with the biases that wander alone, two flats that saturate with
    them."""
    folder = tmp_path / "data" / "real2" / "alta_bias"
    folder.mkdir(parents=True)
    rng = np.random.default_rng(4)
    frames = {f"bias{n}": rng.integers(3000, 3100, (100, 100)) for n in range(5)}
    frames["white"] = np.full((100, 100), 65535)
    arrays = {key: frame.astype(np.uint16) for key, frame in frames.items()}
    np.savez(folder / "frames.npz", **arrays)
    rows = [f"{key},dark,0,,-35,none,x" for key in arrays]
    head = "frame,kind,exposure_s,gain_iso,temperature_c,light,source_file"
    (folder / "frames.csv").write_text("\n".join([head, *rows]) + "\n")
    monkeypatch.setattr(module, "BUILD", tmp_path / "build")
    said = {"biases-that-wander": sets()["biases-that-wander"] | {"unsaturated": True}}
    said["ccd"] = sets()["ccd"]
    (tmp_path / "cameras.json").write_text(json.dumps(said))
    monkeypatch.setattr(module, "FILE", tmp_path / "cameras.json")
    return tmp_path / "data"


def test_frames_become_captures_and_what_is_absent_is_said(data):
    (case,), absent = cameras(data)
    assert absent == [f"ccd: left out, {data} has no real/ccd/*_-5C.npz"]
    found, _ = case.captures()
    raws = [capture.raw() for capture in found.captures]
    assert len(raws) == 5 and all(3000 <= raw.min() <= raw.max() < 3100 for raw in raws)
    assert {capture.exposure_time for capture in found.captures} == {0.0}
    assert found.sensor.black_level == [3092]
    assert case.expected()["black_level_drift"]["sigma"] == 4.3 / (65535 - 3092)


def test_without_a_folder_it_says_so(monkeypatch, capsys, tmp_path):
    monkeypatch.delenv(VARIABLE, raising=False)
    path = str(tmp_path / "records.jsonl")
    for suite in ("cameras", "real"):
        assert command.main([suite, "--json", path]) == 1
        assert f"give one by --data or {VARIABLE}" in capsys.readouterr().err
