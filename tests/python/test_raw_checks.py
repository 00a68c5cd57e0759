# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""RAW frames and their sensor: what does not belong together is refused or said."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

import cg2raw
from cg2raw.io.raw_checks import (
    check_alike,
    check_levels,
    check_sensor,
    first_unlike,
    together,
)
from cg2raw.io.raw_file import open_raw
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from python.commands import write_dng

# What is asked of a Sensor.
MADE = SimpleNamespace(
    id="made", cfa="BGGR", bits=12, black_level=[95.0] * 4, white_level=4095
)
SHAPE = (40, 64)  # LibRaw opens no smaller file than 22 x 22


def header(name, **settings):
    return RawHeader(name, Area("active", 0, 0, 4, 6), settings=settings)


def test_frames_are_compared_by_what_both_state():
    frames = [header("a", GAIN="1"), header("b"), header("c", OFFSET="7", GAIN="1")]
    assert first_unlike(frames) is None
    index, words = first_unlike([*frames, header("d", GAIN="1", OFFSET="8")])
    assert index == 3 and words.startswith("d: its OFFSET is 8, that of c is 7: ")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"make": "Canon"}, "make is Canon, that of .*a.dng is NIKON"),
        ({"model": "Z 9"}, "model is Z 9, that of"),
        ({"white_level": 3000}, "white level is 3000 DN, that of .*a.dng is"),
    ],
)
def test_dngs_of_two_cameras_are_not_mixed(tmp_path, change, words):
    changed = write_dng(tmp_path / "b.dng", "A", shape=SHAPE, **change)
    paths = write_dng(tmp_path / "a.dng", "A", shape=SHAPE), changed
    headers = [open_raw(str(path)).header for path in paths]
    check_alike(headers[:1] * 2)
    with pytest.raises(ValueError, match=f"b.dng: its {words}"):
        check_alike(headers)


def test_another_size_than_the_sensor_s_is_said():
    sensor = cg2raw.Sensor("nikon-d40")
    size = Area("active", 0, 0, sensor.height, sensor.width)
    assert check_sensor(dataclasses.replace(header("a"), active=size), sensor) == []
    [note] = check_sensor(header("a"), sensor)
    assert note.startswith(f"is 6x4, the active area of nikon-d40 is {sensor.width}x")


def levels(black, white, **fields):
    fields |= {"black_level": (black - 2.0, black + 2.0), "white_level": white}
    return dataclasses.replace(header("a"), **fields)


@pytest.mark.parametrize(
    ("stated", "note"),
    [
        (header("a"), ""),
        (dataclasses.replace(header("a"), white_level=9), ""),  # tells no scale
        (levels(95, 4095, cfa="BGGR", bits=12), ""),
        (levels(174, 4095), "tags say black level 174 DN, made 95 DN; the profile's "),
        (
            levels(95, 3896),
            "tags say white level 3896 DN, made 4095 DN; the profile's",
        ),
    ],
)
def test_levels_that_are_a_little_other_are_said(stated, note):
    """Up to 2 % of 4000 DN, the range, for black, and 5 % for white."""
    found = check_levels(stated, MADE)
    assert len(found) == bool(note)
    assert not note or found[0].startswith(note)


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        (levels(95, 4095, cfa="RGGB"), "a: its CFA is RGGB, that of made BGGR; give "),
        (levels(95, 4095, bits=14), "a: its bit depth is 14, that of made 12; give"),
        (
            levels(176, 4095),
            "level 176 DN, made 95 DN; they differ by more than 2% of",
        ),
        (levels(95, 3894), "level 3894 DN, made 4095 DN; they differ by more than 5%"),
    ],
)
def test_another_mosaic_or_scale_is_refused(stated, words):
    with pytest.raises(ValueError, match=words):
        check_levels(stated, MADE)


def test_an_area_is_that_of_the_file_which_stays_as_it_is():
    dn = np.arange(60, dtype=np.uint16).reshape(6, 10)
    file = RawFile(
        dataclasses.replace(header("a.npy"), active=Area("active", 1, 2, 4, 6)),
        lambda levels: dn,
    )
    np.testing.assert_array_equal(file.mosaic(), dn[1:5, 2:8])
    np.testing.assert_array_equal(file.mosaic(Area("left", 0, 0, 6, 2)), dn[:, :2])
    cut = dataclasses.replace(file, read=lambda levels: dn[:3])
    with pytest.raises(ValueError, match="a.npy: was changed while it was read; start"):
        cut.mosaic()


def test_a_sentence_on_many_frames_is_said_once():
    said = [(f"{n}.fits", ["warm", "odd"] if n < 3 else ["warm"]) for n in range(5)]
    assert together(said) == [
        "0.fits, 1.fits, 2.fits and 2 more: warm",
        "0.fits, 1.fits, 2.fits: odd",
    ]
