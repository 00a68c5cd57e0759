# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Journal: which files are finished, as JSON lines per image, beside the data set.

The first line is about the image, each other one a row of the manifest, written when
the row's file stands under its final name. A checksum stands before each: a line that
was cut short, damaged or edited is no line, and what it told of is made again.
"""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

from cg2raw.io.atomic_file import failing, write_atomically
from cg2raw.system import open_without_links

Row = dict[str, Any]  # of JSON's types

FOLDER = ".cg2raw"
ENDING = ".jsonl"


def path_of(out: str, image: str) -> str:
    """Return the path of an image's journal."""
    name = hashlib.blake2b(os.fsencode(image), digest_size=16).hexdigest()
    return os.path.join(out, FOLDER, "journal", name[:2], name + ENDING)


def read(path: str) -> tuple[Row | None, dict[str, Row]]:
    """Return (header, {path: row}) of a journal; (None, {}) if there is none."""
    try:
        with open(path, "rb") as stream:
            header = header_in(stream)
            rows = [parsed(line) for line in stream] if header else []
    except FileNotFoundError:
        return None, {}
    return header, {row["path"]: row for row in rows if row and names(row, "path")}


def header_in(stream: BinaryIO) -> Row | None:
    """Return the object of the first line, None if it is about no image."""
    header = parsed(stream.readline())
    return header if names(header, "image") else None


def names(entry: Row | None, field: str) -> bool:
    """Return whether a field of an entry is a text."""
    return entry is not None and isinstance(entry.get(field), str)


def parsed(line: bytes) -> Row | None:
    """Return the object of a whole line, None of any other."""
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    if not line.endswith(b"\n") or checksum != checksum_of(text):
        return None
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def start(path: str, header: Row, rows: Iterable[Row] = ()) -> None:
    """Begin a journal anew, whole or not at all. Raises OSError."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    write_atomically(path, b"".join(line_of(entry) for entry in (header, *rows)))


def append(path: str, row: Row) -> None:
    """Add a row, all of it or none. Raises OSError."""
    flags = os.O_WRONLY | os.O_APPEND
    with (
        failing(path),
        open(open_without_links(path, flags), "ab", buffering=0) as stream,
    ):
        size = os.fstat(stream.fileno()).st_size
        line = line_of(row)
        try:
            while line:
                line = line[stream.write(line) :]
        except OSError:
            stream.truncate(size)
            raise


def line_of(entry: Row) -> bytes:
    """Return one line: a checksum, and JSON."""
    text = json.dumps(entry).encode()
    return checksum_of(text) + b" " + text + b"\n"


def checksum_of(text: bytes) -> bytes:
    """Return 16 hexadecimal digits."""
    return hashlib.blake2b(text, digest_size=8).hexdigest().encode()


def headers(out: str) -> Iterator[tuple[str, Row]]:
    """Yield (path, header) of every journal that can be read."""
    for folder, _, names in os.walk(os.path.join(out, FOLDER, "journal")):
        for name in names:
            path = os.path.join(folder, name)
            if name.endswith(ENDING):
                with open(path, "rb") as stream:
                    header = header_in(stream)
                if header:
                    yield path, header
