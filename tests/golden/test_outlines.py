# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a golden file forgives, and what not."""

import base64
import io
import json

import numpy as np
import pytest
from PIL import Image

from golden.outlines import are_alike, of_html, of_json, of_lines

CURVE = [*np.linspace(0.0, 1.0, 40)]


@pytest.mark.parametrize(
    ("was", "now", "alike"),
    [
        ("12.3 DN", "12.4 DN", True),
        ("12.3 DN", "12.6 DN", False),
        ("12.3 DN", "12.3 e-", False),
        ("0.123456789", "0.123456999", True),
        ("0.123456789", "0.123466789", False),
        ("7.968903469e-45", "7.968999999e-45", True),
        ("1e300", "4e300", False),
        ("\u22120.39", "\u22120.39", True),
        ("M58 150.9H408", "M58 150.8H408", True),
        ("M58 150.9H408", "M58 150.9V408", False),
        ("one line more", None, False),
    ],
)
def test_numbers_may_differ_by_their_rounding(was, now, alike):
    assert are_alike(was, now) == alike


@pytest.mark.parametrize("place", range(0, 40, 13))
def test_each_number_of_many_shows(place):
    other = [*CURVE]
    other[place] += 0.01
    was, now = (of_json(json.dumps({"curve": some})) for some in (CURVE, other))
    assert len(was) == 1 and len(was[0]) < 80
    assert not are_alike(was[0], now[0])


def test_short_parts_of_json_have_a_line_each():
    found = of_json('{"a": {"b": 1, "c": [2.5, true, "x"]}, "d": ["%s"]}' % ("y" * 240))
    assert found == ['a: {b: 1, c: [2.5, true, "x"]}', 'd[0]: "%s"' % ("y" * 240)]


def page(dn=128, at=3, word="DN"):
    """Return a page with a style sheet, a picture, a drawing and a table."""
    file = io.BytesIO()
    pixels = np.full((4, 6), 100, np.uint8)
    pixels[1, at] = dn
    Image.fromarray(pixels).save(file, "png")
    data = base64.b64encode(file.getvalue()).decode()
    return (
        f"<style>p {{top: {dn}px}}</style><p>Mean</p>"
        f'<img src="data:image/png;base64,{data}">'
        f'<svg><circle r="1" cx="2"/><circle r="1" cx="9"/></svg>'
        f"<table><tr><td>1.5</td><td>{word}</td></tr></table>"
    )


def test_a_page_is_its_elements_and_words():
    lines = of_html(page())
    assert lines[:2] == ["<style>", "<p> Mean"]
    assert lines[2].startswith('<img src="(4, 6, 3) (72 numbers) 0.39')
    assert lines[3:5] == ["<svg>", '<circle r="1" cx="2"> <circle r="1" cx="9">']
    assert lines[5:] == ["<table>", "<tr> <td> 1.5 <td> DN"]


@pytest.mark.parametrize("change", [{"dn": 0}, {"at": 4}, {"word": "e-"}])
def test_a_change_of_a_page_shows(change):
    was, now = of_html(page()), of_html(page(**change))
    assert not all(map(are_alike, was, now))


def test_hashes_are_words():
    first, second = ("0" * 20 + "a1", "0" * 20 + "a2")
    many = " 1 2 3 4 5 6 7 8 9" * 20
    assert not are_alike(*(of_lines(one + many)[0] for one in (first, second)))
