# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measured neutrals: which tables are read, and what is wrong with the others."""

import csv

import pytest

from cg2raw.profile.neutrals import read_neutrals

EXPECTED = [[0.5, 0.25], [0.25, 0.5], [2.0, 0.75]]

TABLES = {
    "r,g,b\n1,2,.5\n1,4,2\n4,2,1.5\n": "camera RGB of any scale",
    "R/G,B/G\n.5,.25\n.25,.5\n2,.75\n": "ratios",
    "rg,bg\n.5,.25\n.25,.5\n2,.75\n": "ratios in short",
    "# cards\n\nimage, B , G , R\na,.5,2,1\n,,,\nb,2,4,1 # dim\nc,1.5,2,4": "others",
    "\ufeffr,g,b\r\n1,2,.5\r\n1,4,2\r\n4,2,1.5\r\n": "from a spreadsheet",
}


@pytest.mark.parametrize("text", TABLES, ids=TABLES.get)
def test_tables_that_are_read(tmp_path, text):
    path = tmp_path / "grey.csv"
    path.write_text(text, encoding="utf-8", newline="")
    assert read_neutrals(path) == EXPECTED


def test_bounds_of_neutrals_are_legal(tmp_path):
    path = tmp_path / "grey.csv"
    path.write_text("r/g,b/g\n.01,100\n100,.01\n1,1\n")
    assert read_neutrals(path) == [[0.01, 100], [100, 0.01], [1, 1]]


BAD = {
    "": "is empty; its header must be r,g,b",
    "# only words\n": "is empty",
    "x,y\n1,2\n": ":1: header x, y names no neutrals",
    "1,2,3\n1,2,3\n": "names no neutrals",
    "r,g,b,rg,bg\n1,1,1,1,1\n": "columns of several",
    "r,g,g,b\n1,1,1,1\n": "column g is there twice",
    "r,g,b\n1,1,1\nnan,1,1\n": ':3: r is "nan"; must be a finite number',
    "r,g,b\n\n# grey\n1,1,-1\n": ":4: b is -1; must be above 0",
    "r,g,b\n1,0,1\n": ":2: g is 0",
    "r,g,b\n1,1,inf\n": 'b is "inf"',
    "r,g,b\n1,1\n": ":2: has 2 cells, and line 1 has 3 (r, g, b)",
    "r/g,b/g\n1,hello\n": ':2: b/g is "hello"',
    "r/g,b/g\n1,100.1\n": ":2: b/g 100.1 must be 0.01 to 100",
    "r,g,b\n.009,1,1\n": ":2: r/g 0.009 must be 0.01 to 100; black must be removed",
    "r,g,b\n1,1,1\n2,1,1\n": "holds 2 distinct neutrals",
    "r,g,b\n1,1,1\n2,2,2\n1,1,1\n": "holds 1 distinct neutrals",
    "r,g,b\n": "holds 0 distinct neutrals",
}


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
def test_tables_that_are_refused(tmp_path, text):
    path = tmp_path / "grey.csv"
    path.write_text(text)
    with pytest.raises(ValueError) as caught:
        read_neutrals(path)
    message = str(caught.value)
    assert message.startswith(str(path)) and BAD[text] in message
    assert "\n" not in message


def test_a_file_that_is_no_text(tmp_path):
    path = tmp_path / "grey.csv"
    path.write_bytes(b"r,g,b\n\xff\xfe\x00\n")
    with pytest.raises(ValueError, match="is no text"):
        read_neutrals(path)


def test_the_published_grey_cards(camera_data):
    path = camera_data / "tables/illuminants/samsung_s20fe_night_greycard_105.csv"
    with open(path, newline="") as file:
        rows = [[float(row[c]) for c in "rgb"] for row in csv.DictReader(file)]
    expected = [pytest.approx([r / g, b / g], abs=1e-6) for r, g, b in rows]
    assert read_neutrals(path) == expected and len(rows) == 105
