# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables in text files, as people write them and spreadsheets of all countries save
them: one reader for all.

A row names the columns, in any case; the rows below have a cell for each. Rows that
start with # are comments, and so is what follows a number and " #". The first row says
what separates cells: tabs, else semicolons, else commas. The decimal mark is a point,
or a comma where commas separate nothing; all numbers of a file have the same. UTF-8, or
UTF-16 that begins with a byte order mark."""

import codecs
import csv
import io
import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from cg2raw.io.atomic_file import FilePath
from cg2raw.near_words import one_line

SEPARATORS = ("\t", ";", ",")  # the first of these that a header has
UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
NUMBER = re.compile(r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?", re.ASCII | re.I)
COMMENT = re.compile(r"\s#.*")


@dataclass
class Table:
    """The rows of a file.

    names : of the columns, as the file has them. line : that of the names; 0 without.
    marks : {decimal mark: the line where it was first read}."""

    path: str
    names: Sequence[str]
    line: int
    separator: str
    rows: list["Row"] = field(default_factory=list)
    marks: dict[str, int] = field(default_factory=dict)

    def column(self, name: str) -> int | None:
        """Return where a column is, whatever the case of its name; None if it is
        missing. Raises ValueError if it is there twice."""
        places = [at for at, each in enumerate(self.names) if folded(each) == name]
        if len(places) > 1:
            self.fail(f"column {self.names[places[0]]} is there twice")
        return places[0] if places else None

    def fail(self, message: str) -> NoReturn:
        """Raise ValueError about the row of names."""
        fail(self.path, self.line, message)


@dataclass(frozen=True)
class Row:
    """One row of a table. cells : without blanks around them, one for each name."""

    table: Table
    line: int
    cells: Sequence[str]

    def text(self, column: int | None) -> str:
        """Return the text in a column; empty if there is no such column."""
        return "" if column is None else self.cells[column]

    def number(
        self,
        column: int | None,
        low: float = -math.inf,
        high: float = math.inf,
        missing: bool = False,
    ) -> float:
        """Return the number in a column.

        missing : whether an empty cell, or NaN, is one; it is NaN then.
        Raises ValueError naming file, line, column, value and bounds."""
        text = COMMENT.sub("", self.text(column))
        if missing and text.lower() in ("", "nan"):
            return math.nan
        value = math.nan
        if NUMBER.fullmatch(text) and self._has_mark_of_table(column, text):
            value = float(text.replace(",", "."))
        if not (low <= value <= high and math.isfinite(value)):
            bounds = "" if math.isinf(low) else f" from {low:g} to {high:g}"
            end = ", or empty" if missing else ""
            self.fail(column, f'is "{text}"; must be a finite number{bounds}{end}')
        return value

    def fail(self, column: int | None, message: str) -> NoReturn:
        """Raise ValueError about a column of this row."""
        name = "" if column is None else f"{self.table.names[column]} "
        fail(self.table.path, self.line, f"{name}{message}")

    def _has_mark_of_table(self, column: int | None, text: str) -> bool:
        """Return whether commas may be decimal marks, if this number has one."""
        for mark in {",", "."} & set(text):
            self.table.marks.setdefault(mark, self.line)
        if len(self.table.marks) == 2:
            comma, point = self.table.marks[","], self.table.marks["."]
            self.fail(
                column,
                f'is "{text}"; the decimal mark is a comma in line {comma} and a point '
                f"in line {point}: write all numbers alike",
            )
        return "," not in text or self.table.separator != ","


def read_table(path: FilePath, unnamed: Sequence[str] = ()) -> Table:
    """Return the Table at @path; it has no rows if the file has none.

    unnamed : the columns of a table that may lack a row of names: one whose first cell
    is a number is a row of values then.
    Raises ValueError naming file and line, OSError."""
    path = os.fspath(path)
    lines = [
        "\n" if line.startswith("#") else line
        for line in io.StringIO(read_text(path), newline=None)
    ]
    first = next((line for line in lines if line.strip(" \t\n,;")), "")
    separator = next((mark for mark in SEPARATORS if mark in first), ",")
    reader = csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=True)
    try:
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise ValueError(f"{path}: is no CSV: {error}") from None
    rows = [(line, cells) for line, cells in rows if any(cells)]
    line, names = 0, list(unnamed)
    if rows and not (unnamed and NUMBER.fullmatch(rows[0][1][0])):
        line, names = rows.pop(0)
        while not names[-1]:  # a spreadsheet's empty columns
            names.pop()
    table = Table(path, names, line, separator)
    for line, cells in rows:
        table.rows.append(Row(table, line, fitted(table, line, cells)))
    return table


def fitted(table: Table, line: int, cells: list[str]) -> list[str]:
    """Return as many cells as there are names. Raises ValueError for other rows."""
    count = len(table.names)
    if len(cells) < count or any(cells[count:]):
        where = f"line {table.line}" if table.line else "a table without names"
        names = ", ".join(table.names)
        hint = "; where commas are decimal marks, separate cells by semicolons or tabs"
        fail(
            table.path,
            line,
            f"has {len(cells)} cell{'s' * (len(cells) != 1)}, and {where} has {count} "
            f"({names})"
            + (hint if table.separator == "," and len(cells) > count else ""),
        )
    return cells[:count]


def read_text(path: FilePath) -> str:
    """Return the text of a file. Raises ValueError, OSError."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        text = data.decode("utf-16" if data.startswith(UTF16) else "utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise ValueError(
            f"{path}: is no text in UTF-8, or in UTF-16 with a byte order mark"
        )
    return text


def folded(name: str) -> str:
    """Return a column's name as it is compared: without case and blanks."""
    return "".join(name.casefold().split())


def fail(path: str, line: int, message: str) -> NoReturn:
    """Raise ValueError with file and line before a message."""
    where = f"{path}:{line}" if line else path
    raise ValueError(one_line(f"{where}: {message}"))
