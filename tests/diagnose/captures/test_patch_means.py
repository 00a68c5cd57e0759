# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Charts as tables of patch means: what is there, missing, and wrong."""

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.chart import (
    COLORCHECKER,
    COLORCHECKER_NAMES,
    rec709_from_xyz,
    xyz_from_lab,
)
from cg2raw.diagnose.captures.chart_table import levels_of, plain, read_colors
from cg2raw.diagnose.captures.patch_means import Table, with_bounds
from cg2raw.diagnose.captures.reader import read_captures, read_frames
from cg2raw.diagnose.captures.splits import GROUPS
from diagnose import capture_files as files

SENSOR = cg2raw.Sensor(files.SENSOR)
HEAD = "patch,R,G1,G2,B"
GREYS = "white,300,500,501,400\nneutral 5,150,200,201,160\nblack,80,90,91,85\n"
LINE = "{file: p.csv, kind: chart, chart: colorchecker, illuminant: D65"
INLINE = "[{patch: a, rgb: [1, 1, 1]}, {patch: b, xyz: [0.2, 0.2, 0.2]}, "
INLINE += "{patch: c, lab: [43.139, -13.095, 21.905]}]"  # foliage


def table(folder, text, name="p.csv"):
    """Write a table."""
    (folder / name).write_text(text)


def means_of(folder, text, line=LINE):
    """Return (means, notes) of a set with one table."""
    table(folder, text)
    _, _, [frame], notes = read_frames(files.manifest(folder, [line + "}"]))
    assert frame.capture.shape == frame.capture.means.mean.shape
    return frame.capture.means, notes


def test_means_are_read_as_they_stand(tmp_path):
    text = f"{HEAD},count,R_sd\n" + GREYS.replace("\n", ",400,3\n")
    means, notes = means_of(tmp_path, text)
    assert means.names == ("white", "neutral 5", "black")
    np.testing.assert_array_equal(means.mean[1], [150, 200, 201, 160])
    np.testing.assert_array_equal(means.count, 400)
    assert means.measured.all()
    # Y of white is 0.9, of neutral 5 0.19, of black 0.03: L* 96.5, 50.9 and 20.5.
    luminance = means.colors @ [0.2126, 0.7152, 0.0722]
    np.testing.assert_allclose(luminance, [0.913, 0.192, 0.031], atol=0.002)
    assert not means.level_known
    [absent] = [note for note in notes if "are not in the table" in note]
    assert absent.startswith("p.csv: dark skin, light skin, blue sky and 18 more are")


def test_a_mean_is_of_as_many_pixels_as_its_table_or_the_manifest_says(tmp_path):
    text = f"{HEAD},count\nwhite,300,500,501,400,64\nblack,80,90,91,85,\n"
    for line, other in ((LINE + ", count: 250", 250), (LINE, 1)):
        means, notes = means_of(tmp_path, text, line)
        assert means.count.tolist() == [64, other]
        said = [note for note in notes if "nobody says how many pixels" in note]
        assert len(said) == (other == 1)


def test_signal_becomes_dn(tmp_path):
    text = f"{HEAD},R_sd\nwhite,0,0.5,1,0.25,0.1\n"
    means, notes = means_of(tmp_path, text, LINE + ", unit: signal, gain: 2")
    black, white = SENSOR.black_level[0], SENSOR.white_level
    expected = black + (white - black) * np.array([0, 0.5, 1, 0.25])
    np.testing.assert_allclose(means.mean[0], expected)
    assert means.level_known and means.colors[0, 1] == pytest.approx(1.83, abs=0.03)
    assert any("nobody says how many pixels" in note for note in notes)


@pytest.mark.parametrize(
    ("cfa", "black"),
    [("RGGB", (60, 61, 62, 63)), ("BGGR", (63, 62, 61, 60)), ("GRBG", (61, 60, 63, 62)),
     ("GBRG", (62, 63, 60, 61))],
)  # fmt: skip
def test_the_first_green_of_a_table_is_beside_red(cfa, black):
    sensor = files.other_sensor(cfa=cfa, black_level=[60, 61, 62, 63])
    offset, scale = levels_of(sensor, "signal")
    assert tuple(offset) == black and (offset + scale == sensor.white_level).all()


@pytest.mark.parametrize(
    ("name", "known"),
    [("White 9.5 (.05 D)", "white"), ("neutral_6.5", "neutral 6.5"), ("24", "black"),
     ("Dark  Skin", "dark skin"), ("25", "25"), ("A1", "a1"),
     ("black 2 (1.5 D)", "black")],
)  # fmt: skip
def test_names_of_patches(name, known):
    assert plain(name) == known and len(set(COLORCHECKER_NAMES)) == 24


@pytest.mark.parametrize(
    ("head", "row", "expected"),
    [
        ("r,g,b", "0.5,0.25,0.125", (0.5, 0.25, 0.125)),
        ("X,Y,Z", "0.9642957,1,0.8251046", (1, 1, 1)),  # D50 is white
        ("L,a,b", "100,0,0", (1, 1, 1)),
    ],
)
def test_colours_of_a_table(tmp_path, head, row, expected):
    table(tmp_path, f"patch,{head}\nA1,{row}\n", "colours.csv")
    line = LINE.replace("colorchecker", "colours.csv")
    means, _ = means_of(tmp_path, f"{HEAD}\na1,1,2,3,4\n", line)
    np.testing.assert_allclose(means.colors[0], expected, atol=1e-3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("r,g,b\nA1,1,1,1\na1,0,0,0\n", ':3: patch "a1" is there twice'),
        ("r,g\nA1,1,1\n", "columns must be patch and r, g, b or X, Y, Z or L, a, b"),
        ("r,g,b,X,Y,Z\nA1,1,1,1,1,1,1\n", "columns must be patch and r, g, b or X,"),
        ("L,a,b\nA1,201,0,0\n", ':2: L is "201"; must be a finite number from -200 to'),
        ("L,a,b\nA1,200,0,-201\n", ':2: b is "-201"; must be a finite number from'),
        ("r,g,b\nA1,-1.1,0,0\n", ':2: r is "-1.1"; must be a finite number from -1 to'),
    ],
)
def test_colours_that_are_no_colours_are_told_by_their_line(tmp_path, text, words):
    table(tmp_path, f"patch,{text}", "colours.csv")
    with pytest.raises(ValueError) as error:
        read_colors(str(tmp_path / "colours.csv"))
    assert words in str(error.value)


def test_colours_of_the_manifest(tmp_path):
    line = LINE.replace("chart: colorchecker", f"patches: {INLINE}")
    means, _ = means_of(tmp_path, f"{HEAD}\nb,1,2,3,4\na,5,6,7,8\nc,4,4,4,4\n", line)
    assert means.names == ("b", "a", "c")
    assert means.colors[1] == pytest.approx([1, 1, 1])
    foliage = rec709_from_xyz(xyz_from_lab(COLORCHECKER[3]))
    assert means.colors[2] == pytest.approx(foliage)


def bounds(rows, cut=("", "", ""), known=(None, None)):
    """Return (mean, side, inferred) of red of three greys, dark to bright."""
    mean = np.array([[value] * 4 for value in rows], float)
    colors = np.array([[grey] * 3 for grey in (0.1, 0.5, 0.9)])
    found = with_bounds(
        Table(("a", "b", "c"), mean, np.full(3, np.nan), cut), colors, known
    )
    assert all((one == one[:, :1]).all() for one in found[1:])
    return tuple(one[:, 0].tolist() for one in found)


NAN = float("nan")


@pytest.mark.parametrize(
    ("arguments", "mean", "side", "inferred"),
    [
        (((10, 20, 30),), [10, 20, 30], [0, 0, 0], [False] * 3),
        (((NAN, 20, 30),), [20, 20, 30], [-1, 0, 0], [True, False, False]),
        (((10, 20, NAN),), [10, 20, 20], [0, 0, 1], [False, False, True]),
        (((10, NAN, 30),), [10, NAN, 30], [0, 0, 0], [False] * 3),
        (((NAN, 20, 30), ("low", "", "")), [20, 20, 30], [-1, 0, 0], [False] * 3),
        (((10, NAN, 30), ("", "high", "")), [10, 30, 30], [0, 1, 0], [False] * 3),
        (((NAN, 20, NAN), ("", "", ""), (15, 25)), [15, 20, 25], [-1, 0, 1],
         [True, False, True]),
        (((NAN, NAN, NAN),), [NAN] * 3, [0, 0, 0], [False] * 3),
        (((NAN, NAN, NAN), ("low", "", ""), (15, None)), [15, NAN, NAN], [-1, 0, 0],
         [False] * 3),
        (((10, 20, 30), ("low", "", "high")), [10, 20, 30], [0, 0, 0], [False] * 3),
    ],
)  # fmt: skip
def test_what_is_known_of_missing_patches(arguments, mean, side, inferred):
    found = bounds(*arguments)
    np.testing.assert_array_equal(found[0], mean)
    assert found[1:] == (side, inferred)


def test_bounds_are_those_of_each_site():
    dark, bright, none = [10, 20, 30, 40], [50, 70, 60, 80], [NAN] * 4
    colors = np.array([[grey] * 3 for grey in (0.1, 0.4, 0.6, 0.9)])
    table = Table(
        (*"abcd",), np.array([none, dark, bright, none]), np.ones(4), 4 * ("",)
    )
    mean, side, _ = with_bounds(table, colors, (None, None))
    assert mean.tolist() == [dark, dark, bright, bright]
    assert side.tolist() == [4 * [one] for one in (-1, 0, 0, 1)]


def test_the_manifest_says_from_where_on_means_are_missing(tmp_path):
    text = f"{HEAD}\n{GREYS}".replace("black,80", "black,").replace(",400", ",")
    means, _ = means_of(tmp_path, text, LINE + ", cut_below: 70, cut_above: 900")
    assert (means.mean[2, 0], means.side[2, 0]) == (70, -1)
    assert (means.mean[0, 3], means.side[0, 3]) == (900, 1)


def test_how_missing_patches_count_is_said(tmp_path):
    text = f"{HEAD}\n{GREYS}neutral 8,,nan,NaN,\nred,1,2,3,\n"
    text = text.replace("black,80", "black,")
    _, notes = means_of(tmp_path, text)
    unknown = "neutral 8 (R, G1, G2, B), red (B) are missing, and nothing says on which"
    assert any(unknown in note for note in notes)
    assert any("the surround" in note for note in notes) is False


@pytest.mark.parametrize(
    ("cuts", "words"),
    [
        (
            "",
            [
                "black (R) are missing, darker than all that were measured: they count "
                "as cut below those",
                "white (R) are missing, brighter than all that were measured: they "
                "count as cut above those",
            ],
        ),
        ("high,low", []),  # which the table says itself
    ],
)
def test_on_which_side_patches_were_cut_is_inferred_unless_it_is_said(
    tmp_path, cuts, words
):
    white, black = cuts.split(",") if cuts else ("", "")
    rows = f"white,,1,1,1,{white}\nblack,,1,1,1,{black}\nneutral 5,5,5,5,5,\n"
    means, notes = means_of(tmp_path, f"{HEAD},cut\n{rows}")
    said = [note for note in notes if "are missing" in note]
    assert said == [f"p.csv: {one}" for one in words]
    assert means.side[:2, 0].tolist() == [1, -1]


BAD = {
    "no G2": ("patch,R,G1,B\n", ":1: column G2 is missing; columns are patch, R"),
    "unknown": (f"{HEAD},x\na,1,1,1,1,1\n", ":1: column x is unknown; columns are"),
    "twice": (f"{HEAD},R\n", ":1: column R is there twice"),
    "empty": (f"{HEAD}\n", "p.csv: has no patch; add at least one row"),
    "nothing": ("", "p.csv: column patch is missing"),
    "short": (f"{HEAD}\nwhite,1,1\n", ":2: has 3 cells, and line 1 has 5"),
    "a word": (f"{HEAD}\nwhite,1,one,1,1\n", ':2: G1 is "one"; must be a finite num'),
    "negative": (f"{HEAD}\nwhite,1,1,1,-1\n", ':2: B is "-1"; must be a finite numb'),
    "infinite": (f"{HEAD}\nwhite,1,1,1,inf\n", ':2: B is "inf"; must be a finite num'),
    "count": (f"{HEAD},count\nwhite,1,1,1,1,0\n", ':2: count is "0"; must be a finite'),
    "cut": (f"{HEAD},cut\nwhite,1,1,1,1,dark\n", ':2: cut is "dark"; must be low, h'),
    "same": (f"{HEAD}\nwhite,1,1,1,1\n\nwhite,1,1,1,1\n", ':4: patch "white" is there '
             "twice, first in line 2"),
    "no name": (f"{HEAD}\n ,1,1,1,1\n", ':2: patch "" is empty'),
    "no colour": (f"{HEAD}\npink,1,1,1,1\n", '[0].chart has no colour for "pink"'),
    "bytes": (b"\xff\xfe\x00", "is no text"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_table_is_told_by_its_line(tmp_path, name):
    text, words = BAD[name]
    raw = text if isinstance(text, bytes) else text.encode()
    (tmp_path / "p.csv").write_bytes(raw)
    with pytest.raises(ValueError) as caught:
        read_captures(files.manifest(tmp_path, [LINE + "}"]))
    assert words in str(caught.value) and "\n" not in str(caught.value)


BAD_LINES = [
    ("{file: p.csv, kind: flat, scene: 1}", "file is a table of patch means, wh"),
    ("{file: p.csv, kind: chart}", "has neither patches nor chart; patch means need o"),
    (LINE + ", corners: [[1, 2]]}", "corners is not for patch means; remove it"),
    (LINE + ", mask: p.csv}", "mask is not for patch means; remove it"),
    (LINE + ", unit: volt}", 'unit is "volt"; must be one of DN, signal'),
    (LINE + ", count: 0}", "count is '0'; must be a number, 1 to 1e+09 pixels"),
    (LINE.replace("checker", "card") + "}", 'is "colorcard"; must be one of color'),
    (LINE.replace("colorchecker", "none.csv") + "}", "there is no file"),
    (LINE.replace("chart: colorchecker", "patches: [{patch: a, rgb: [1, 1, 1]}, "
                  "{patch: a, rgb: [1, 1, 1]}]") + "}", '"a" is there twice; give'),
    (LINE.replace("chart: colorchecker", "patches: []") + "}", "has no patch; add at"),
    (LINE.replace("chart: colorchecker", "patches: [{patch: a}]") + "}", "has no col"),
    ("{file: a.npy, kind: chart, patches: [{area: [0, 0, 9, 9], rgb: [1, 1, 1]}], "
     "count: 3}", "count is not for a chart in a frame; remove it"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "words"), BAD_LINES)
def test_a_bad_entry_is_told_by_its_line(tmp_path, line, words):
    files.frame(tmp_path, "a.npy")
    table(tmp_path, f"{HEAD}\n{GREYS}")
    with pytest.raises(ValueError) as caught:
        read_captures(files.manifest(tmp_path, [line]))
    assert words in str(caught.value) and ":3: frames[0]" in str(caught.value)


def test_a_sensor_without_a_bayer_cfa_has_no_such_means(tmp_path):
    table(tmp_path, f"{HEAD}\n{GREYS}")
    path = files.manifest(tmp_path, [LINE + "}"], "sensor: fujifilm-x-m1")
    with pytest.raises(ValueError, match="is a table of R, G1, G2 and B, and the CFA"):
        read_captures(path)


def test_one_table_is_divided_by_patches(tmp_path):
    table(tmp_path, f"{HEAD}\n{GREYS}red,1,2,3,4\n")
    files.frame(tmp_path, "dark.npy")
    lines = [LINE + "}", "{file: dark.npy, kind: dark}"]
    captures = read_captures(files.manifest(tmp_path, lines)).captures
    tables = [capture for capture in captures if capture.means is not None]
    assert [capture.group for capture in tables] == list(GROUPS)
    names = [capture.means.names for capture in tables]
    assert names == [("white", "red"), ("neutral 5",), ("black",)]
    assert [capture.shape for capture in tables] == [(2, 4), (1, 4), (1, 4)]


def test_a_check_of_a_table(tmp_path):
    table(tmp_path, f"{HEAD}\n{GREYS}neutral 8,1023,500,500,400\n")
    files.frame(tmp_path, "dark.npy")
    lines = [LINE + "}", "{file: dark.npy, kind: dark}"]
    found = files.checked(tmp_path, lines)
    [words] = found.integrities[0].complaints
    assert "a mean of 1023 DN is at white (1023 DN): clipped patches belong" in words
    assert (found.integrities[0].low, found.integrities[0].high) == (80, 1023)
    assert not found.is_right and not found.integrities[1].complaints


def test_a_table_of_which_nothing_was_measured_is_no_chart(tmp_path):
    table(tmp_path, f"{HEAD}\nwhite,,,,\n")
    [found] = files.checked(tmp_path, [LINE + "}"]).integrities
    assert found.complaints == ("no patch has a mean: nothing was measured",)
