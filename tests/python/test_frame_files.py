# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The files of shots: patterns, frame lists, what is missing or there twice."""

import re

import pytest

from cg2raw.io import frame_files

NAMES = ("shot.0009.exr", "shot.0010.exr", "shot.0012.exr", "shot.10000.exr")
OTHERS = ("shot.exr", "shot.7.exr", "shot.0010.png", "other.0010.exr", "shot.00011.exr")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return the current folder, which has NAMES and OTHERS."""
    for name in NAMES + OTHERS:
        (tmp_path / name).touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("pattern", ["shot.####.exr", "shot.%04d.exr", "shot.@@@@.exr"])
def test_a_pattern_is_its_numbered_files(folder, pattern):
    """Four digits, and more where four do not do; leading zeros only up to four."""
    assert frame_files.expanded([pattern]) == list(NAMES)
    assert frame_files.expanded([str(folder / pattern)]) == [
        str(folder / name) for name in NAMES
    ]


@pytest.mark.parametrize("pattern", ["shot.#.exr", "shot.@.exr", "shot.%d.exr"])
def test_a_pattern_of_any_digits(folder, pattern):
    found = frame_files.expanded([pattern])
    assert set(found) == {*NAMES, "shot.7.exr", "shot.00011.exr"}
    numbers = [int(re.findall(r"\d+", name)[0]) for name in found]
    assert numbers == sorted(numbers)


def test_other_words(folder):
    (folder / "notes.txt").touch()
    assert frame_files.expanded(["x.exr", "shot.exr"]) == ["x.exr", "shot.exr"]
    assert frame_files.expanded(["other*"]) == ["other.0010.exr"]
    images = frame_files.expanded([str(folder)])
    assert len(images) == len(NAMES + OTHERS) and images == sorted(images)
    (folder / "take#1.exr").touch()
    assert frame_files.expanded(["take#1.exr"]) == ["take#1.exr"]


@pytest.mark.parametrize("word", ["none.####.exr", "none*.exr", "empty"])
def test_words_that_name_no_file(folder, word):
    (folder / "empty").mkdir()
    with pytest.raises(ValueError, match="no "):
        frame_files.expanded([word])


def test_frame_lists():
    assert frame_files.frame_list("1001-1004") == [1001, 1002, 1003, 1004]
    assert frame_files.frame_list("1-10x3") == [1, 4, 7, 10]
    assert frame_files.frame_list("9, 1,3-4") == [1, 3, 4, 9]
    for words in (
        "",
        "1-",
        "4-1",
        "1-4x0",
        "1,2,2",
        "1-3,3",
        "a",
        "1..4",
        "0-99999999",
    ):
        with pytest.raises(ValueError, match="^" + re.escape(words)):
            frame_files.frame_list(words)


def test_frames_are_listed_as_people_do():
    assert frame_files.listed([1, 2, 3, 5, 7, 8]) == "1-3, 5, 7-8"
    assert frame_files.listed([4]) == "4"


def test_numbers_of_names():
    for path, number, shot in (
        ("a/shot.0007.exr", 7, "a/shot.#.exr"),
        ("render0012.exr", 12, "render#.exr"),
        ("v002/shot_v002.0007.beauty.exr", 7, "v002/shot_v002.#.beauty.exr"),
        ("2024.1001.exr", 1001, "2024.#.exr"),
    ):
        name = frame_files.name_of(path)
        assert (name.number, name.shot) == (number, shot)
    assert frame_files.name_of("comp_v002.exr") is None
    assert frame_files.numbered("raw/shot.####.dng", 7) == "raw/shot.0007.dng"
    assert frame_files.numbered("shot.%05d.dng", 7) == "shot.00007.dng"
    assert frame_files.numbered("shot.#.dng", 10001) == "shot.10001.dng"
    assert frame_files.numbered("shot.%d.dng", 7) == "shot.7.dng"


def test_what_is_missing_or_there_twice():
    paths = [
        "s.1.exr",
        "s.0001.exr",
        "s.0002.exr",
        "s.0005.exr",
        "t.8.exr",
        "still.exr",
    ]
    first, second = frame_files.shots_of(paths, None)
    assert first.files == {2: "s.0002.exr", 5: "s.0005.exr"} and first.first == 1
    assert first.missing == [3, 4] and first.twice == {1: ["s.1.exr", "s.0001.exr"]}
    assert [text for _, text in first.faults()] == [
        "frames 3-4 are missing",
        "is frame 1, as s.0001.exr is; neither is done: keep one",
    ]
    assert second.files == {8: "t.8.exr"} and not list(second.faults())
    (only,) = frame_files.shots_of(paths, [2, 5, 6])
    assert only.missing == [6] and list(only.files) == [2, 5]
