# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Whether an OpenEXR file is complete, from its header and its table of chunks.

Plain Python, so that a run need not load an image library to see what is done.
Source: OpenEXR, "OpenEXR File Layout" (openexr.com)."""

import struct
from dataclasses import dataclass

MAGIC = 20000630
LINES = {
    0: 1,
    1: 1,
    2: 1,
    3: 16,
    4: 32,
    5: 16,
    6: 32,
    7: 32,
    8: 32,
    9: 256,
}  # a chunk's
LONGEST_HEADER = 1 << 20  # bytes; a header of ours has about 500


@dataclass(frozen=True)
class Header:
    """Size in pixels, attributes' raw bytes by name, and where the chunks' table is."""

    width: int
    height: int
    lines: int
    attributes: dict
    end: int


def read_header(data):
    """Return the Header of a single-part scan-line file. Raises ValueError."""
    if len(data) < 8 or struct.unpack("<I", data[:4])[0] != MAGIC:
        raise ValueError("is no OpenEXR file")
    attributes, at = {}, 8
    while at < len(data) and data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size = struct.unpack_from("<i", data, at)[0] if at + 4 <= len(data) else -1
        if size < 0 or at + 4 + size > len(data):
            raise ValueError("ends within its header")
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    try:
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        lines = LINES[attributes["compression"][0]]
    except (KeyError, struct.error, IndexError):
        raise ValueError("has no complete header") from None
    return Header(x1 - x0 + 1, y1 - y0 + 1, lines, attributes, at + 1)


def text_at(data, at):
    """Return the text that ends in a zero byte at @at, and where the next byte is."""
    end = data.find(b"\0", at)
    if end < 0:
        raise ValueError("ends within its header")
    return data[at:end].decode("latin-1"), end + 1


def complete_size(path):
    """Return a complete file's width and height. Raises ValueError, OSError."""
    with open(path, "rb") as file:
        data = file.read(LONGEST_HEADER)
        header = read_header(data)
        count = -(-header.height // header.lines)
        table = data[header.end : header.end + 8 * count]
        if len(table) < 8 * count:
            raise ValueError("ends within its table of chunks")
        offsets = struct.unpack(f"<{count}Q", table)
        end = file.seek(0, 2)
        for offset in offsets:
            if not 0 < offset <= end - 8:
                raise ValueError("lacks some of its lines")
            file.seek(offset)
            _, size = struct.unpack("<ii", file.read(8))
            if size < 0 or offset + 8 + size > end:
                raise ValueError("ends within its lines")
    return header.width, header.height
