# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds of lossless JPEG: python -m fuzz.jpeg_seeds FOLDER, in tests.

All of them are made up here; FOLDER/jpeg is made. Source: ITU-T T.81 (1992)."""

import random
import struct
import sys

from fuzz.mosaic_seeds import bytes_of
from fuzz.seed_folders import write_seeds

PREDICTORS = {
    1: lambda left, above, corner: left,
    2: lambda left, above, corner: above,
    3: lambda left, above, corner: corner,
    4: lambda left, above, corner: left + above - corner,
    5: lambda left, above, corner: left + ((above - corner) >> 1),
    6: lambda left, above, corner: above + ((left - corner) >> 1),
    7: lambda left, above, corner: (left + above) >> 1,
}
FLAT_TABLE = bytes(
    [0, 0, 0, 0, 0, 17, *[0] * 11, *range(17)]
)  # five bits for each size
SOI, EOI = b"\xff\xd8", b"\xff\xd9"
SOF3, DHT, SOS, DRI, COM = 0xC3, 0xC4, 0xDA, 0xDD, 0xFE


def predicted(rows, row, i, components, predictor, precision):
    """Return what stands for a sample before it is known."""
    if i < components:
        return rows[row - 1][i] if row else 1 << (precision - 1)
    left = rows[row][i - components]
    if row == 0:
        return left
    above, corner = rows[row - 1][i], rows[row - 1][i - components]
    return PREDICTORS[predictor](left, above, corner)


def code_of(difference):
    """Return the ones and zeros of a difference, by FLAT_TABLE."""
    difference = (difference + 32767) % 65536 - 32767
    size = abs(difference).bit_length()
    if size == 0 or difference == 32768:
        return f"{size:05b}"
    low = difference - (difference < 0) & (1 << size) - 1
    return f"{size:05b}{low:0{size}b}"


def segment(marker, data):
    return struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data


def frame(lines, columns, components, precision, sampling=0x11):
    """Return the segment SOF3."""
    names = b"".join(bytes([c, sampling, 0]) for c in range(components))
    head = struct.pack(">BHHB", precision, lines, columns, components)
    return segment(SOF3, head + names)


def scan(components, predictor=1, table=0, transform=0):
    """Return the segment SOS."""
    names = b"".join(bytes([c, table << 4]) for c in range(components))
    return segment(SOS, bytes([components]) + names + bytes([predictor, 0, transform]))


def samples(rows, components, predictor, precision):
    """Return the bits of all rows, their 0xff stuffed."""
    text = "".join(
        code_of(value - predicted(rows, row, i, components, predictor, precision))
        for row, values in enumerate(rows)
        for i, value in enumerate(values)
    )
    return bytes_of(text).replace(b"\xff", b"\xff\0")


def picture(lines, width, precision, seed=1):
    """Return rows of random samples."""
    rng = random.Random(seed)
    return [[rng.randrange(1 << precision) for _ in range(width)] for _ in range(lines)]


def jpeg(rows, components=1, predictor=1, precision=10, tables=FLAT_TABLE, before=b""):
    """Return lossless JPEG of rows of samples, components interleaved."""
    columns = len(rows[0]) // components
    head = before + frame(len(rows), columns, components, precision)
    head += segment(DHT, tables) + scan(components, predictor)
    return SOI + head + samples(rows, components, predictor, precision) + EOI


def refused():
    """Return {name: bytes} of what the decoder does not take."""
    rows = picture(4, 6, 10)
    whole = jpeg(rows)
    table, data = segment(DHT, FLAT_TABLE), samples(rows, 1, 1, 10)
    head = SOI + frame(4, 6, 1, 10)
    return {
        "restarts": jpeg(rows, before=segment(DRI, b"\0\4")),
        "baseline": whole.replace(b"\xff\xc3", b"\xff\xc0"),
        "point_transform": head + table + scan(1, transform=1) + data + EOI,
        "predictor_8": head + table + scan(1, predictor=8) + data + EOI,
        "no_table": head + scan(1) + data + EOI,
        "other_table": head + table + scan(1, table=1) + data + EOI,
        "no_frame": SOI + table + scan(1) + data + EOI,
        "subsampled": SOI + frame(4, 6, 1, 10, 0x22) + table + scan(1) + data + EOI,
        "no_scan": head + table + EOI,
        "truncated": whole[:-12],
        "cut_in_its_head": whole[:20],
        "too_many_codes": jpeg(rows, tables=bytes([0, 3, *[0] * 15, 0, 0, 0])[:20]),
        "size_17": jpeg(rows, tables=FLAT_TABLE[:-1] + b"\x11"),
    }


def accepted():
    """Return {name: bytes} of what the decoder takes."""
    files = {
        f"predictor_{n}": jpeg(picture(4, 6, 10, n), predictor=n) for n in PREDICTORS
    }
    for components in (2, 3, 4):
        rows = picture(3, 5 * components, 12, components)
        files[f"components_{components}"] = jpeg(rows, components, 6, 12)
    for bits in (2, 8, 16):
        files[f"bits_{bits}"] = jpeg(picture(5, 7, bits, bits), 1, 7, bits)
    extremes = [[0, 32768, 0, 65535], [65535, 0, 32768, 0]]
    files["half_range"] = jpeg(extremes, 1, 1, 16)
    # A code of one bit for 0, others of 15 and 16 bits, beyond the quick table.
    counts = bytes([0, 1, *[0] * 13, 8, 8])
    long_codes = counts[:17] + bytes(range(17))
    zeros = SOI + frame(4, 6, 1, 10) + segment(DHT, long_codes) + scan(1)
    files["long_codes"] = zeros + bytes_of("0" * 23 + "1" + "0" * 14 + "1") + EOI
    comment = segment(COM, b"a comment") + b"\xff"
    files["comment_and_fill"] = jpeg(picture(4, 6, 10), before=comment)
    files["one_sample"] = jpeg([[5]], precision=4)
    files["without_end"] = jpeg(picture(4, 6, 10))[:-2]
    return files


def jpegs():
    return accepted() | refused()


def main(folder):
    """Write all seeds to a folder of folder."""
    write_seeds(folder, {"jpeg": jpegs()})


if __name__ == "__main__":
    main(sys.argv[1])
