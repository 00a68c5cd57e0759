# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Charts of pages: ticks are round, nothing is outside, nothing collides."""

import re

import numpy as np
import pytest

from cg2raw.io import svg
from cg2raw.io.svg import Axis, Mark, bars, lines

LABELS = ("exposure time, s", "rms, DN")


@pytest.mark.parametrize(
    ("ends", "is_log", "ticks"),
    [
        ((0, 1), False, [0, 0.2, 0.4, 0.6, 0.8, 1]),
        ((5.9, 7.1), False, [6, 6.5, 7]),
        ((-1.2, 1.2), False, [-1, -0.5, 0, 0.5, 1]),
        ((0, 300), False, [0, 100, 200, 300]),
        ((0.2, 2000), True, [1, 10, 100, 1000]),
        ((1e-9, 1e3), True, [1e-9, 1e-6, 1e-3, 1, 1e3]),
        ((30, 90), True, [40, 60, 80]),
    ],
)
def test_ticks_are_round_and_few(ends, is_log, ticks):
    assert Axis(*ends, 0, 100, is_log).ticks == pytest.approx(ticks)


def places(drawn, tag, *names):
    """Return the numbers of attributes of all tags of a name."""
    pattern = f"<{tag} " + ".*?".join(f'{name}="([-0-9.]+)"' for name in names)
    return np.array(re.findall(pattern, drawn), float)


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("scale", ["linear linear", "log log"])
def test_points_lie_within_and_in_order(size, scale):
    y = size * np.array([1.0, 3.0, 2.0])
    drawn = lines("three", [Mark("a", np.arange(1.0, 4), y, "dots")], LABELS, scale)
    x, down = places(drawn, "circle", "cx", "cy")[-3:].T  # before them, the legend's
    assert (x >= svg.LEFT).all() and (x <= svg.RIGHT).all() and (np.diff(x) > 0).all()
    assert (down >= svg.TOP).all() and (down <= svg.BOTTOM).all()
    assert down[1] < down[2] < down[0]  # more is higher up


def test_a_logarithmic_axis_has_equal_ratios_equally_far_apart():
    mark = Mark("", 2.0 ** np.arange(4), np.ones(4), "dots")
    x = places(lines("powers", [mark], LABELS, "log linear"), "circle", "cx")
    assert np.diff(x) == pytest.approx(np.diff(x)[0], abs=0.2)  # tenths are written


@pytest.mark.parametrize(
    ("start", "end"),
    [
        (0, 1.0),
        (0, 123456.0),
        (0, 3e-7),
        (123456700, 123456800),
        (0.0001234, 0.0001239),
    ],
)
def test_labels_of_an_axis_do_not_collide(start, end):
    mark = Mark("a", np.linspace(start, end, 9), np.linspace(0, 1, 9), "solid")
    drawn = lines("words", [mark], LABELS)
    ticks = re.findall(r'x="([\d.]+)" y="186.0" text-anchor="middle">([^<]+)<', drawn)
    ends = [(float(x), svg.LETTER * len(words) / 2) for x, words in ticks]
    assert len(ticks) >= 2 and len({words for _, words in ticks}) == len(ticks)
    for (one, half), (other, other_half) in zip(ends, ends[1:], strict=False):
        assert one + half < other - other_half


def test_a_legend_fits_and_its_entries_do_not_collide():
    names = ("without it", "with it", "R", "Gr", "Gb", "B")
    one = np.ones(2)
    drawn = lines("many", [Mark(name, one, one, "solid") for name in names], LABELS)
    at = [
        float(re.search(rf'x="([\d.]+)" y="32.0"[^>]*>{name}<', drawn)[1])
        for name in names
    ]
    widths = [svg.LETTER * len(name) for name in names]
    gaps = np.diff(at) - np.array(widths[:-1])
    assert (gaps > 26).all() and at[-1] + widths[-1] <= svg.WIDTH


def test_a_band_lies_to_both_sides_of_nothing():
    half = np.array([1.0, 2.0, 1.5])
    drawn = lines("noise", [Mark("a", np.arange(3.0), half, "band")], LABELS)
    [points] = re.findall(r'<polygon points="([^"]+)"', drawn)
    down = np.array([pair.split(",")[1] for pair in points.split()], float)
    assert (down >= svg.TOP).all() and (down <= svg.BOTTOM).all()
    upper, lower = down[:3], down[:2:-1]
    np.testing.assert_allclose(upper + lower, 2 * down.mean(), atol=0.2)
    narrow = [Mark("a", np.ones(2), half[:2], "band"), Mark("b", half, half, "solid")]
    assert "<polygon" not in lines("noise", narrow, LABELS)  # of no width


def test_bars_begin_at_nothing_and_have_rows_of_their_own():
    values = np.array([2.0, -1.0])
    marks = [Mark("found", np.arange(2.0), values, "solid", svg.AFTER)]
    drawn = bars("two", ["right", "down"], marks, "r")
    x, y, width = places(drawn, "rect", "x", "y", "width").T
    assert x[0] == pytest.approx(x[1] + width[1], abs=0.11)  # zero
    assert width[0] == pytest.approx(2 * width[1], rel=0.01) and y[1] > y[0] + 8


def test_bars_of_one_name_lie_about_its_dot():
    y = np.array([2.0, 3.0, 1.0])
    marks = [Mark(f"{n}", y, n * y, "solid") for n in (1, 2, 3)]
    marks += [Mark("seen", y, y, "dots")]
    drawn = bars("rows", ["a", "b", "c"], marks, "r")
    rows = places(drawn, "rect", "x", "y")[:, 1].reshape(3, 3) + 4  # middles of bars
    dots = places(drawn, "circle", "cx", "cy")[:, 1]
    assert dots[1:] == pytest.approx(rows[:, 1])  # after the legend's
    assert np.diff(rows).ravel() == pytest.approx(9)  # px, of bars 8 px high
    assert (rows[1:, 0] - rows[:-1, 2] > 9).all()


def test_what_is_no_number_is_not_drawn():
    y = np.array([1.0, np.nan, 2.0, np.inf])
    drawn = lines("gaps", [Mark("a", np.arange(4.0), y, "dots")], LABELS)
    assert drawn.count("<circle") == 2 + 1 and "nan" not in drawn
    nothing = Mark("a", np.zeros(2), np.full(2, np.nan), "dots")
    assert lines("none", [nothing], LABELS) == bars("none", ["b"], [], "") == ""


@pytest.mark.parametrize("style", ["dots", "solid"])
def test_what_a_logarithmic_axis_has_no_place_for_is_not_drawn(style):
    x, y = np.array([0.0, 1.0, 10.0, 100.0]), np.array([1.0, -1.0, 2.0, 3.0])
    drawn = lines("log", [Mark("a", x, y, style)], LABELS, "log log")
    same = lines("log", [Mark("a", x[2:], y[2:], style)], LABELS, "log log")
    assert drawn == same
    assert lines("log", [Mark("a", -x, y, style)], LABELS, "log linear") == ""
    assert lines("linear", [Mark("a", -x, y, style)], LABELS) != ""


def test_words_cannot_become_markup():
    one = np.ones(2)
    drawn = lines("<b>", [Mark("<i>", one, one, "solid")], ("<u>", "<p>"))
    assert not re.search("<[biup]>", drawn) and drawn.count("&lt;") == 5


def test_words_that_are_too_long_are_cut_to_their_width():
    assert svg.shortened("pixel", 5 * svg.LETTER) == "pixel"
    assert svg.shortened("pixels", 5 * svg.LETTER) == "pixe\N{HORIZONTAL ELLIPSIS}"
