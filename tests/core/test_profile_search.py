# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""profile_search.cpp: words that no file can be named by are sought nowhere."""

import json
import re

import pytest

import cg2raw
from oracles import cameras

NO_IDS = ("..", ".", "....", "a" * 300, "A" * 101, "a\nb", "a\x7f")


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return the folder in which profiles are sought first."""
    folder = tmp_path / "shelf"
    folder.mkdir()
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(folder))
    return folder


def refused(word, most=400):
    with pytest.raises(ValueError) as error:
        cg2raw.Sensor(word)
    message = str(error.value)
    assert message.isprintable() and len(message) < most, message
    return message


@pytest.mark.parametrize("word", NO_IDS)
def test_a_word_that_is_no_id_is_refused_in_one_line(shelf, word):
    shown = re.sub(r"[\0-\x1f\x7f]", "?", word)
    shown = shown if len(word) <= 160 else shown[:160] + "..."
    line = refused(word)
    assert line.startswith(f'sensor "{shown}" must be of lower-case letters, digits, ')
    assert line.endswith("; or give the path of a profile (.json)")


def test_a_file_of_dots_is_not_read(shelf):
    """With "..", the file "...json" of a folder that is searched was read."""
    text = cameras.profile_text()
    for name in ("...json", "..json", "mine.json"):
        (shelf / name).write_text(text)
    assert cg2raw.Sensor("mine").id == json.loads(text)["id"]
    for word in ("..", "."):
        refused(word)


def test_a_path_is_not_cut_at_a_null_byte(shelf):
    """A name that ends where the system stops reading is another file's name."""
    path = shelf / "mine.json"
    path.write_text(cameras.profile_text())
    cg2raw.Sensor(str(path))
    for word in (f"{path}\0.png", "nikon-d40\0", "\0"):
        line = refused(word)
        assert line.startswith("path ") and line.endswith(" holds a NUL character")


def test_a_word_that_may_be_an_id_is_still_told_what_is_near():
    line = refused("Nikon D40", most=1000)
    assert line.startswith('unknown sensor "Nikon D40"; did you mean nikon-d40? ')
    assert refused("a" * 100, most=1000).startswith('unknown sensor "aaa')
