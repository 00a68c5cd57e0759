# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Translators on disk: trained once, anew for other settings or frames."""

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed")

from studies.learners import translation  # noqa: E402
from studies.learners.translation_store import translator_for  # noqa: E402
from studies.protocol import PROTOCOL  # noqa: E402
from studies.sources.frames import Frames  # noqa: E402
from studies.sources.sets import Material  # noqa: E402

RULES = replace(
    PROTOCOL.translation,
    steps={"quick": 2, "full": 3},
    record=2,
    batch=2,
    crop=16,
    patch=16,
)


def material(seed):
    def frames(key):
        rng = np.random.default_rng([seed, key])
        neutrals = np.array([[0.5, 1.0, 0.6]] * 6)
        return Frames(list(rng.random((6, 16, 20, 3), np.float32)), neutrals)

    renders = frames(2).images
    return Material(frames(0), frames(1), renders, renders)


def ask(folder, said, mode="quick", seed=0, rules=RULES, of=0):
    return translator_for(
        material(of), "a", "day", seed, mode, folder, rules=rules, say=said.append
    )


@pytest.fixture
def no_step(monkeypatch):
    """Return a function after which no step can be taken."""

    def forbid():
        monkeypatch.setattr(translation.Training, "advance", None)

    return forbid


def test_a_translator_is_trained_once(tmp_path, no_step):
    said = []
    first = ask(tmp_path, said)
    written = (tmp_path / "translation" / "a-day-0.json").read_bytes()
    no_step()
    again = ask(tmp_path, said)
    images = material(0).renders
    assert np.array_equal(first(images), again(images))
    assert (tmp_path / "translation" / "a-day-0.json").read_bytes() == written
    found = json.loads(written)
    assert found["curve"] == first.curve and found["floor"] == first.floor
    assert found["settings"]["steps"] == 2 and found["settings"]["seed"] == 0
    assert said == []


@pytest.mark.parametrize(
    "other",
    [
        {"mode": "full"},
        {"rules": replace(RULES, content=3.0)},
        {"of": 1},
    ],
)
def test_other_settings_or_frames_are_trained_anew(tmp_path, other):
    said = []
    ask(tmp_path, said)
    found = ask(tmp_path, said, **other)
    assert len(said) == 1 and "a-day-0.pt: is of other settings" in said[0]
    fresh = ask(tmp_path / "fresh", said, **other)
    images = material(0).renders
    assert np.array_equal(found(images), fresh(images))
    assert len(said) == 1


def test_seeds_have_files_of_their_own(tmp_path):
    said = []
    one, other = (ask(tmp_path, said, seed=seed) for seed in (0, 1))
    assert said == []
    assert {path.name for path in (tmp_path / "translation").iterdir()} == {
        f"a-day-{seed}.{kind}" for seed in (0, 1) for kind in ("pt", "json")
    }
    images = material(0).renders
    assert not np.array_equal(one(images), other(images))
