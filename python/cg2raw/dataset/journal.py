# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Journal: which files are finished, as JSON lines per image, beside the data set.

The first line is about the image, each other one a row of the manifest, written when
the row's file stands under its final name. A checksum stands before each: a line that
was cut short, damaged or edited is no line, and what it told of is made again.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

from cg2raw.io.atomic_file import failing, write_in
from cg2raw.system import Folder

Row = dict[str, Any]  # of JSON's types

FOLDER = ".cg2raw"
ENDING = ".jsonl"


def path_of(out: str, image: str) -> str:
    """Return the path of an image's journal."""
    name = hashlib.blake2b(os.fsencode(image), digest_size=16).hexdigest()
    return os.path.join(out, FOLDER, "journal", name[:2], name + ENDING)


def read(path: str) -> tuple[Row | None, dict[str, Row]]:
    """Return (header, {path: row}) of a journal; (None, {}) if there is none.

    Raises OSError for a link."""
    header, texts = read_texts(path)
    return header, by_path(texts)


def read_texts(path: str) -> tuple[Row | None, list[bytes]]:
    """Return (header, JSON of each whole line after it) of a journal, (None, []) if
    there is none. Raises OSError for a link."""
    try:
        with folder_of(path) as folder, opened(folder, path) as stream:
            header = header_in(stream)
            texts = [text_of(line) for line in stream] if header else []
    except FileNotFoundError:
        return None, []
    return header, [text for text in texts if text is not None]


def header(path: str) -> Row | None:
    """Return the header of a journal, None if there is none. Raises OSError for a
    link."""
    try:
        with folder_of(path) as folder, opened(folder, path) as stream:
            return header_in(stream)
    except FileNotFoundError:
        return None


def by_path(texts: Iterable[bytes]) -> dict[str, Row]:
    """Return {path: row} of rows as JSON."""
    rows = map(object_of, texts)
    return {row["path"]: row for row in rows if row and names(row, "path")}


def folder_of(path: str, make: bool = False) -> Folder:
    """Return the Folder of a journal; no link in a data set's folder leads to it.

    make : those folders that are missing. Raises OSError."""
    folder = os.path.dirname(path)
    mark = f"{os.sep}{FOLDER}{os.sep}"
    if mark not in folder:
        return Folder(folder)
    out, _, below = folder.rpartition(mark)
    return Folder(out or os.sep, os.path.join(FOLDER, below), make)


def opened(folder: Folder, path: str) -> BinaryIO:
    """Return a stream of a journal in its Folder. Raises OSError."""
    return open(folder.open(os.path.basename(path), os.O_RDONLY), "rb")


def header_in(stream: BinaryIO) -> Row | None:
    """Return the object of the first line, None if it is about no image."""
    header = parsed(stream.readline())
    return header if names(header, "image") else None


def names(entry: Row | None, field: str) -> bool:
    """Return whether a field of an entry is a text."""
    return entry is not None and isinstance(entry.get(field), str)


def parsed(line: bytes) -> Row | None:
    """Return the object of a whole line, None of any other."""
    text = text_of(line)
    return None if text is None else object_of(text)


def text_of(line: bytes) -> bytes | None:
    """Return what stands after the checksum of a whole line, None of any other."""
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    whole = line.endswith(b"\n") and checksum == checksum_of(text)
    return text if whole else None


def object_of(text: bytes) -> Row | None:
    """Return a JSON object, None of any other text."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def start(path: str, header: Row, rows: Iterable[Row] = ()) -> None:
    """Begin a journal anew, whole or not at all. Raises OSError."""
    data = b"".join(line_of(entry) for entry in (header, *rows))
    with failing(path), folder_of(path, make=True) as folder:
        write_in(folder, os.path.basename(path), data, path)


def append(path: str, row: Row) -> None:
    """Add a row, all of it or none. Raises OSError."""
    flags = os.O_WRONLY | os.O_APPEND
    with (
        failing(path),
        folder_of(path) as folder,
        open(folder.open(os.path.basename(path), flags), "ab", buffering=0) as stream,
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
    """Yield (path, header) of every journal that can be read. Raises OSError for what
    is no file of ours, such as a link."""
    below = os.path.join(FOLDER, "journal")
    try:
        with Folder(out, below) as folder:
            groups = folder.names()
    except FileNotFoundError:
        return
    for group in groups:
        with (
            contextlib.suppress(NotADirectoryError),
            Folder(out, os.path.join(below, group)) as folder,
        ):
            for name in folder.names():
                path = folder.path_of(name)
                if not name.endswith(ENDING):
                    continue
                with opened(folder, path) as stream:
                    header = header_in(stream)
                if header:
                    yield path, header
