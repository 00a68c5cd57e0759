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


@pytest.mark.parametrize("pattern", ["s.####.exr", "s.%04d.exr", "s.#.exr", "s.%d.exr"])
def test_frames_below_0_are_of_the_pattern(tmp_path, monkeypatch, pattern):
    """With as many digits as others, or one fewer for the sign, as printf has it."""
    monkeypatch.chdir(tmp_path)
    names = ["s.-0003.exr", "s.-002.exr", "s.0000.exr", "s.0001.exr"]
    for name in [*names[::-1], "s-0003.exr", "s.-x.exr"]:
        (tmp_path / name).touch()
    assert frame_files.expanded([pattern]) == names
    (tmp_path / "t-0003.exr").touch()  # a separator
    with pytest.raises(ValueError, match="no file of that name"):
        frame_files.expanded(["t####.exr"])
    assert frame_files.expanded(["t-####.exr"]) == ["t-0003.exr"]


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
    for words, frames in (
        ("1001-1004", [1001, 1002, 1003, 1004]),
        ("1-10x3", [1, 4, 7, 10]),
        ("9, 1,3-4", [1, 3, 4, 9]),
        ("-5-5x5", [-5, 0, 5]),
        ("-5--2", [-5, -4, -3, -2]),
        ("-3,0,3", [-3, 0, 3]),
        ("1-9x2,2-8x2", [1, 3, 5, 7, 9, 2, 4, 6, 8]),
    ):
        assert [n for r in frame_files.frame_list(words) for n in r] == frames
    assert frame_files.frame_list("1,2,3-9") == [range(1, 10)]


BAD = {
    "": "must be frames as",
    "1-": "must be frames as",
    "a": "must be frames as",
    "1..4": "must be frames as",
    "\u0661": "must be frames as",  # a digit, but not of 0-9
    "4-1": "4-1 must rise, as 1-4",
    "-2--5": "-2--5 must rise, as -5--2",
    "1-4x0": "the step of 1-4x0 must be at least 1",
    "1,2,2": "frame 2 is there twice",
    "1-3,3": "frame 3 is there twice",
    "1-9999999999999999999": "a frame number has at most 18 digits",
    "9" * 5000: "a frame number has at most 18 digits",
}


@pytest.mark.parametrize("words", BAD, ids=lambda words: words[:22])
def test_frame_lists_that_are_none(words):
    with pytest.raises(ValueError) as error:
        frame_files.frame_list(words)
    assert str(error.value).startswith(f"{words}: {BAD[words]}")


def test_frames_of_two_ranges():
    """Against the sets, for all small ranges that rise by other steps."""
    parts = [range(a, a + 14, step) for a in (-4, 0, 3) for step in (1, 2, 3, 4, 6)]
    for one in parts:
        for other in parts:
            both = sorted(set(one) & set(other))
            assert list(frame_files.common(one, other)) == both


def test_frames_are_listed_as_people_do():
    assert frame_files.listed([range(1, 4), range(5, 6), range(7, 9)]) == "1-3, 5, 7-8"
    assert frame_files.listed([range(4, 5), range(5, 8)]) == "4-7"
    assert frame_files.listed([range(-3, 2), range(4, 9, 2)]) == "-3-1, 4-8x2"
    gaps = [range(n, n + 1) for n in range(0, 100, 2)]
    assert frame_files.listed(gaps).endswith("36, 38 and 30 more")


def test_long_gaps_are_not_worked_out_one_by_one():
    """10^17 frames would be no list and no time."""
    wanted = frame_files.frame_list("1-99999999999999999")
    (shot,) = frame_files.shots_of(["s.0001.exr", "s.0003.exr"], wanted)
    assert list(shot.files) == [1, 3]
    (fault,) = shot.faults()
    assert fault[1] == "frames 2, 4-99999999999999999 are missing"
    (shot,) = frame_files.shots_of(["s.0001.exr", "s.99999999999.exr"], None)
    assert shot.missing == [range(2, 99999999999)]


def test_numbers_of_names():
    for path, number, shot in (
        ("a/shot.0007.exr", 7, "a/shot.#.exr"),
        ("render0012.exr", 12, "render#.exr"),
        ("v002/shot_v002.0007.beauty.exr", 7, "v002/shot_v002.#.beauty.exr"),
        ("2024.1001.exr", 1001, "2024.#.exr"),
    ):
        (found,) = frame_files.shots_of([path], None)
        assert (found.first, found.name) == (number, shot)
    assert not frame_files.shots_of(["comp_v002.exr"], None)
    assert frame_files.numbered("raw/shot.####.dng", -3) == "raw/shot.-0003.dng"
    assert frame_files.numbered("shot.%04d.dng", -3) == "shot.-003.dng"
    assert frame_files.numbered("raw/shot.####.dng", 7) == "raw/shot.0007.dng"
    assert frame_files.numbered("shot.%05d.dng", 7) == "shot.00007.dng"
    assert frame_files.numbered("shot.#.dng", 7) == "shot.0007.dng"
    assert frame_files.numbered("a#/shot_@@.##.dng", 7) == "a#/shot_07.##.dng"
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
    assert first.missing == [range(3, 5)] and first.twice == {
        1: ["s.1.exr", "s.0001.exr"]
    }
    assert [text for _, text in first.faults()] == [
        "frames 3-4 are missing",
        "is frame 1, as s.0001.exr is; neither is done: keep one",
    ]
    assert second.files == {8: "t.8.exr"} and not list(second.faults())
    [fault] = frame_files.shot_of("s", {1: ["a"], 3: ["b"]}, None).faults()
    assert fault == ("s", "frame 2 is missing")
    (only,) = frame_files.shots_of(paths, [range(2, 3), range(5, 7)])
    assert only.missing == [range(6, 7)] and list(only.files) == [2, 5]


@pytest.mark.parametrize("wanted", [[range(1, 12)], [range(0, 6), range(7, 30, 3)]])
def test_missing_frames_are_those_wanted_that_are_not_there(wanted):
    every = [n for part in wanted for n in part]
    for there in ({1}, {7, 8, 9}, {0, 5, 11, 28}, {2, 3, 10, 13}, set(every), {99}):
        rest = frame_files.without(wanted, there)
        assert [n for part in rest for n in part] == [
            n for n in every if n not in there
        ]
        assert all(rest)
