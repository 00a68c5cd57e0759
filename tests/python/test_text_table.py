# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables as people write them, and as spreadsheets of several countries save them."""

import codecs

import pytest

from cg2raw.io.text_table import read_table
from cg2raw.profile.spectral_file import read_power

PLAIN = "name,a,b\nx,1.5,-2\ny,0.25,1.5e-3\n"
VALUES = [("x", 1.5, -2.0), ("y", 0.25, 0.0015)]
GERMAN = PLAIN.replace(",", ";").replace(".", ",")
UTF16_LE = codecs.BOM_UTF16_LE + PLAIN.replace(",", "\t").encode("utf-16-le")
FORMS = {
    "plain": PLAIN,
    "mark of UTF-8": "\ufeff" + PLAIN,
    "CRLF": PLAIN.replace("\n", "\r\n"),
    "CR": PLAIN.replace("\n", "\r"),
    "no last line end": PLAIN.rstrip("\n"),
    "semicolons": PLAIN.replace(",", ";"),
    "tabs": PLAIN.replace(",", "\t"),
    "decimal commas": GERMAN,
    "tabs and decimal commas": GERMAN.replace(";", "\t"),
    "UTF-16, little-endian": UTF16_LE,
    "UTF-16, big-endian": codecs.BOM_UTF16_BE + GERMAN.encode("utf-16-be"),
    "blanks": PLAIN.replace(",", " , "),
    "quotes": PLAIN.replace("x", '"x"').replace("1.5,-2", '"1.5", "-2"'),
    "comments": "# of cards\n\n" + PLAIN.replace("-2", "-2 # dim") + "# end\n",
    "empty cells": PLAIN.replace("\n", ",,\n") + ",,,,\n",
    "capitals": PLAIN.replace("name,a", "Name,A"),
}


def written(folder, content):
    path = folder / "t.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_what_the_plain_one_gives(tmp_path, form):
    table = read_table(written(tmp_path, FORMS[form]))
    name, a, b = map(table.column, ("name", "a", "b"))
    found = [(row.text(name), row.number(a), row.number(b)) for row in table.rows]
    assert found == VALUES and table.column("c") is None


CELLS = (
    "1.000,5", "1,000.5", "1 000", "5 nm", "1_0", "#N/A", "NaN", "inf", "", "--1",
    "0x1", "\u0661",
)  # fmt: skip


@pytest.mark.parametrize("cell", CELLS)
def test_what_is_no_number_is_refused_at_line_and_column(tmp_path, cell):
    table = read_table(written(tmp_path, f"a;b\n1;2\n3;{cell}\n"))
    with pytest.raises(ValueError, match=r"t.csv:3: b is .* must be a finite number"):
        table.rows[1].number(1)


def test_a_missing_number_is_one_only_where_it_may_be(tmp_path):
    row = read_table(written(tmp_path, "a,b\n,NaN\n")).rows[0]
    assert row.number(0, missing=True) != row.number(1, missing=True)  # NaN
    with pytest.raises(ValueError, match=r'a is ""; must be .* from 0 to 9$'):
        row.number(0, 0, 9)


@pytest.mark.parametrize(
    ("cell", "good"),
    [("-1", True), ("2", True), ("-1.001", False), ("2.001", False), ("", False)],
)
def test_bounds_are_legal_values(tmp_path, cell, good):
    row = read_table(written(tmp_path, f"a;b\n{cell};x\n")).rows[0]
    if good:
        assert row.number(0, -1, 2) == float(cell)
        return
    words = rf't.csv:2: a is "{cell}"; must be a finite number from -1 to 2$'
    with pytest.raises(ValueError, match=words):
        row.number(0, -1, 2)


BAD = {
    "commas for both": (
        "a,b\n1,5,2\n",
        r":2: has 3 cells, and line 1 has 2 \(a, b\); w",
    ),
    "a quoted comma": ('a,b\n2,"1,234"\n', r':2: b is "1,234"; must be'),
    "a short row": ("a;b\n1\n", r":2: has 1 cell, and line 1 has 2 \(a, b\)$"),
    "two decimal marks": ("a;b\n1.5;2\n3;1,234\n", "comma in line 3 and a point in l"),
    "the same name": ("a,b, B\n1,2,3\n", ":1: column b is there twice"),
    "no text": (b"a,b\n\xff,1\n", "is no text in UTF-8"),
    "UTF-16 without a mark": ("a,b\n1,2\n".encode("utf-16-le"), "is no text in UTF-8"),
    "an open quote": ('a,b\n"1,2\n', "is no CSV"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_nobody_can_tell_is_refused(tmp_path, case):
    content, message = BAD[case]
    path = written(tmp_path, content)
    with pytest.raises(ValueError, match=message) as caught:
        table = read_table(path)
        assert table.column("b") == 1
        assert all(row.number(at) for row in table.rows for at in (0, 1))
    assert str(caught.value).startswith(str(path))


def test_a_lamp_with_commas_for_both_is_not_cut_off(tmp_path):
    rows = [f"{nm},1,{nm}" for nm in range(380, 785, 5)]
    for head, where in (
        (["wavelength,power"], "line 1"),
        ([], "a table without names"),
    ):
        path = written(tmp_path, "\n".join([*head, *rows]))
        with pytest.raises(ValueError, match=f"has 3 cells, and {where} has 2"):
            read_power(path)
