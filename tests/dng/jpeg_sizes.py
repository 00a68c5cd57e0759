# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How small a lossless JPEG of a tile can be: by trying everything.

A DNG's lossless JPEG may have its samples in lines of one row or of two, of one, two or
four components, any of seven predictors, and a Huffman table for all components or one
for each. What is counted are the bits of an optimal code without a bound on its
lengths, and the headers, but no stuffed bytes: no encoder makes less of the tile.
Source: ITU-T T.81 (1992), annexes B, H, K.2."""

import heapq

import numpy as np

SIZES = np.arange(17)  # of differences, in bits
OWN_BITS = np.where(SIZES == 16, 0, SIZES)
PREDICTORS = range(1, 8)


def layouts(tile):
    """Yield (lines (n, pixels, components) int32) of a tile (H, W) of even sides."""
    height, width = tile.shape
    for rows in (1, 2):
        for components in (1, 2, 4):
            shape = height // rows, rows * width // components, components
            yield tile.astype(np.int32).reshape(shape)


def differences(lines, predictor):
    """Return (samples of a component, components) int32, modulo 2^16."""
    left, above, corner = lines[1:, :-1], lines[:-1, 1:], lines[:-1, :-1]
    predicted = {
        1: left,
        2: above,
        3: corner,
        4: left + above - corner,
        5: left + ((above - corner) >> 1),
        6: above + ((left - corner) >> 1),
        7: (left + above) >> 1,
    }[predictor]
    components = lines.shape[2]
    parts = (
        lines[1:, 1:] - predicted,  # all but the first line and the first column
        np.diff(lines[0], axis=0),
        np.diff(lines[:, 0], axis=0),
        lines[0, :1] - 2048,  # half the range: of some 12 bits
    )
    flat = np.concatenate([part.reshape(-1, components) for part in parts])
    return (flat + 32768) % 65536 - 32768


def histogram(values):
    """Return (17,) int64: how often each size occurs."""
    sizes = np.frexp(np.abs(values).astype(np.float64))[1]  # exact: whole numbers
    return np.bincount(sizes.ravel(), minlength=17)


def code_bits(counts):
    """Return the bits of all codes of the best Huffman code, which keeps one symbol
    more for itself: JPEG forbids a code of ones alone."""
    heap = [1, *(2 * count for count in map(int, counts) if count)]
    heapq.heapify(heap)
    total = 0
    while len(heap) > 1:
        merged = heapq.heappop(heap) + heapq.heappop(heap)
        total += merged
        heapq.heappush(heap, merged)
    return total // 2


def least_bytes(tile, predictors=PREDICTORS):
    """Return the bytes of the smallest lossless JPEG of a tile (H, W) of DN."""
    best = np.inf
    for lines in layouts(tile):
        for predictor in predictors:
            found = differences(lines, predictor)
            each = [histogram(found[:, c]) for c in range(lines.shape[2])]
            for tables in ([sum(each)], each):
                bits = sum(code_bits(t) + int((t * OWN_BITS).sum()) for t in tables)
                best = min(best, bits / 8 + header_bytes(tables, len(each)))
    return best


def header_bytes(tables, components):
    """Return the bytes of SOI, the DHTs, SOF3, SOS and EOI."""
    codes = sum(17 + np.count_nonzero(table) for table in tables)
    return 2 + (4 + codes) + (10 + 3 * components) + (8 + 2 * components) + 2
