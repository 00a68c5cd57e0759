# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is finished of each image: a file of JSON lines per image, beside the data set.

The first line is about the image, each other one a row of the manifest, written when
the row's file stands under its final name. A line that was cut short is no line.
"""

import hashlib
import json
import os

FOLDER = ".cg2raw"


def path_of(out, image):
    """Return the path of an image's journal."""
    name = hashlib.blake2b(os.fsencode(image), digest_size=16).hexdigest()
    return os.path.join(out, FOLDER, "journal", name[:2], f"{name}.jsonl")


def read(path):
    """Return (header, {path: row}) of a journal; (None, {}) if there is none."""
    try:
        with open(path, "rb") as stream:
            lines = [parsed(line) for line in stream]
    except FileNotFoundError:
        return None, {}
    if not lines or lines[0] is None:
        return None, {}
    return lines[0], {row["path"]: row for row in lines[1:] if row is not None}


def parsed(line):
    """Return the object of a whole line, None of one that was cut short."""
    if not line.endswith(b"\n"):
        return None
    try:
        return json.loads(line)
    except ValueError:
        return None


def start(path, header, rows=()):
    """Begin a journal anew, whole or not at all."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    part = f"{path}.{os.getpid()}.part"
    with open(part, "wb") as stream:
        stream.write(b"".join(line_of(entry) for entry in (header, *rows)))
    os.replace(part, path)


def append(path, row):
    """Add a row by one write, so that it is whole or cut short, never mixed."""
    handle = os.open(path, os.O_WRONLY | os.O_APPEND)
    try:
        os.write(handle, line_of(row))
    finally:
        os.close(handle)


def line_of(entry):
    """Return one line of JSON."""
    return json.dumps(entry).encode() + b"\n"


def headers(out):
    """Yield (path, header) of every journal."""
    for folder, _, names in os.walk(os.path.join(out, FOLDER, "journal")):
        for name in names:
            path = os.path.join(folder, name)
            with open(path, "rb") as stream:
                header = parsed(stream.readline())
            if header and name.endswith(".jsonl"):
                yield path, header
