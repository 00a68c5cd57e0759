# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds of DNGs with pixels: python -m fuzz.mosaic_seeds FOLDER, in tests.

All of them are made up here, of 12 x 12 pixels. FOLDER/mosaic is made."""

import random
import struct
import sys

from fuzz.make_seeds import LONG, SHORT, X_TRANS, camera, dng, raw, without
from fuzz.seed_folders import write_seeds

SIDE = 12
NONE, JPEG = 1, 7
VALUES = random.Random(1).choices(range(64, 1024), k=SIDE * SIDE)


def bits_of(values, bits):
    """Return values as text of ones and zeros."""
    return "".join(f"{value:0{bits}b}" for value in values)


def bytes_of(bits):
    """Return bytes of a text of ones and zeros; the last one is filled with ones."""
    bits += "1" * (-len(bits) % 8)
    return bytes(int(bits[i : i + 8], 2) for i in range(0, len(bits), 8))


def rows(values, width, bits, order):
    """Return rows of samples as TIFF stores them."""
    if bits == 16:
        return struct.pack(f"{order}{len(values)}H", *values)
    mask = (1 << bits) - 1
    return b"".join(
        bytes_of(bits_of([v & mask for v in values[i : i + width]], bits))
        for i in range(0, len(values), width)
    )


def jpeg(values, columns, components, sof=0xC3):
    """Return lossless JPEG, predictor 1, a Huffman code of five bits for each size."""
    row, text = columns * components, ""
    for i, value in enumerate(values):
        left = values[i - components] if i % row >= components else None
        above = values[i - row] if i >= row else 1 << 9
        difference = value - (above if left is None else left)
        size = abs(difference).bit_length()
        low = difference - (difference < 0) & (1 << size) - 1
        text += f"{size:05b}" + (f"{low:0{size}b}" if size else "")
    table = bytes([0, 0, 0, 0, 0, 17, *[0] * 11, *range(17)])
    names = [bytes([c, 0x11, 0]) for c in range(components)]
    scan = [bytes([c, 0]) for c in range(components)]
    frame = struct.pack(">BHHB", 10, len(values) // row, columns, components)
    segments = (
        (0xC4, table),
        (sof, frame + b"".join(names)),
        (0xDA, bytes([components]) + b"".join(scan) + bytes([1, 0, 0])),
    )
    head = b"".join(
        struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data
        for marker, data in segments
    )
    return b"\xff\xd8" + head + bytes_of(text).replace(b"\xff", b"\xff\0") + b"\xff\xd9"


def with_pixels(tags, chunks, order, tile=None):
    """Return a DNG whose strips, or tiles of a size, stand behind its directories."""
    offsets, counts = (324, 325) if tile else (273, 279)
    if tile:
        tags = tags | {322: (LONG, [tile[0]]), 323: (LONG, [tile[1]])}
    lengths = [len(chunk) for chunk in chunks]

    def file(start):
        places = [start + sum(lengths[:i]) for i in range(len(chunks))]
        more = {offsets: (LONG, places), counts: (LONG, lengths)}
        return dng(camera() | tags | more, order=order)

    return file(len(file(0))) + b"".join(chunks)


def mosaics():
    """Return {name: bytes}."""
    xtrans = ["RGB".index(letter) for letter in X_TRANS]
    mono = without(raw(t262=(SHORT, [34892])), 33421, 33422)
    halves = [VALUES[:72], VALUES[72:]]
    quarters = [
        [
            VALUES[12 * row + col]
            for row in range(top, top + 6)
            for col in range(x, x + 6)
        ]
        for top in (0, 6)
        for x in (0, 6)
    ]
    packed = raw(t259=(SHORT, [JPEG]))
    files = {}
    for order, end in (("<", "little"), (">", "big")):

        def add(name, tags, chunks, tile=None, order=order, end=end):
            files[f"{name}_{end}"] = with_pixels(tags, chunks, order, tile)

        whole = [rows(VALUES, SIDE, 16, order)]
        for bits in (8, 10, 12, 14):
            tags = raw(t258=(SHORT, [bits]), t50717=(SHORT, [255]))
            add(f"bits_{bits}", tags, [rows(VALUES, SIDE, bits, order)])
        add("bits_16", raw(), whole)
        add("x_trans", raw(6, xtrans), whole)
        add("mono", mono, whole)
        add("active_area", raw(t50829=(LONG, [1, 2, 11, 12])), whole)
        add("linearization", raw(t50712=(SHORT, list(range(0, 1024, 64)))), whole)
        strips = [rows(half, SIDE, 16, order) for half in halves]
        add("strips", raw(t278=(LONG, [6])), strips)
        add("tiles", raw(), [rows(part, 6, 16, order) for part in quarters], (6, 6))
        add("jpeg", packed, [jpeg(VALUES, 12, 1)])
        add("jpeg_of_pairs", packed, [jpeg(VALUES, 6, 2)])
        add("jpeg_tiles", packed, [jpeg(part, 3, 2) for part in quarters], (6, 6))
        add("lossy_jpeg", packed, [jpeg(VALUES, 6, 2, sof=0xC0)])
        add("without_matrix", raw(t50721=(SHORT, [0])), whole)
    return files


def main(folder):
    """Write all seeds to a folder of folder."""
    write_seeds(folder, {"mosaic": mosaics()})


if __name__ == "__main__":
    main(sys.argv[1])
