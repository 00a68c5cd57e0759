# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The catalogue: an effect is a registered name and one file, and nothing else."""

import shutil
import sys
from pathlib import Path

import pytest

from cg2raw import _core
from cg2raw.diagnose import diagnose, effects
from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects import catalogue
from cg2raw.diagnose.scenes.model import Model
from diagnose.test_pipeline import SENSOR, set_of

NAME = "gr_gb_imbalance"
FILE = """
from cg2raw.diagnose.effects.base import Effect


class Greens(Effect):
    name = "gr_gb_imbalance"
    title = "greens that differ"
    where = "every other row of green"


EFFECT = Greens()
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder of all effects' files but one, which the catalogue collects."""
    for file in Path(effects.__path__[0]).glob("*.py"):
        if file.stem != NAME:
            shutil.copy(file, tmp_path)
    monkeypatch.setattr(effects, "__path__", [str(tmp_path)])
    monkeypatch.delitem(sys.modules, f"{effects.__name__}.{NAME}", raising=False)
    catalogue.every.cache_clear()
    yield tmp_path
    catalogue.every.cache_clear()


def test_every_registered_effect_has_a_file():
    assert list(catalogue.every()) == [effect["name"] for effect in _core.effects()]
    assert set(catalogue.names()) == set(catalogue.every()) - {"quantisation"}


@pytest.mark.parametrize("name", catalogue.names())
def test_its_words_exist(name):
    effect = catalogue.every()[name]
    assert effect.title and effect.where
    assert not effect.title.endswith(".") and not effect.where.endswith(".")
    one = Estimate(0.1, "1", (0.05, 0.15))
    values = dict.fromkeys(effect.parameters, one)
    size = effect.size_on(values, SENSOR)
    assert any(letter.isdigit() for letter in size) and not size.endswith(".")
    assert effect.signature <= {"gain", "mixer", "softener", "offset", "noise", "map"}
    assert set(effect.taken_up_by) <= set(catalogue.names()) - {name}
    assert effect.shapes <= set(effect.parameters)


def test_a_registered_effect_without_a_file_is_an_error(folder):
    with pytest.raises(ValueError, match=f'the effect "{NAME}", and .* no file for'):
        catalogue.every()


def test_a_file_without_a_registered_effect_is_an_error(folder):
    (folder / f"{NAME}.py").write_text(FILE)
    (folder / "fog.py").write_text(FILE.replace(NAME, "fog"))
    try:
        with pytest.raises(ValueError, match="add plugins/effects/fog.cpp and build"):
            catalogue.every()
    finally:
        del (
            sys.modules[f"{effects.__name__}.fog"],
            sys.modules[f"{effects.__name__}.{NAME}"],
        )


def test_one_file_makes_an_effect_that_can_be_diagnosed(folder):
    (folder / f"{NAME}.py").write_text(FILE)
    try:
        effect = catalogue.effect(NAME)
        assert effect.title == "greens that differ"
        model = Model(SENSOR).with_effect(effect, [0.02, -0.02])
        found = diagnose(set_of(SENSOR, model=model), threads=1, details=False)
        assert [one.name for one in found.effects] == [NAME]
        assert found.effects[0].sentence.startswith("Greens that differ: gr 0.0")
        assert found.profile_json and NAME in found.profile_json
    finally:
        del sys.modules[f"{effects.__name__}.{NAME}"]


def test_names_that_cannot_be_left_out_are_refused():
    with pytest.raises(ValueError, match='effect "fog" cannot be left out'):
        catalogue.candidates("RGGB", without=["fog"])
    with pytest.raises(ValueError, match='effect "quantisation" cannot be left out'):
        catalogue.candidates("RGGB", without=["quantisation"])
