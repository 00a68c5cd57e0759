# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random files of ours: LibRaw, dcraw, tifffile and our own reader read equal words."""

import numpy as np
import pytest

from dng import differential

FEW, MANY = 60, 10000


@pytest.fixture(
    scope="module", params=[FEW, pytest.param(MANY, marks=pytest.mark.slow)]
)
def result(request, program):
    """Return the Result of a few files, or of many."""
    program("dcraw")
    return differential.compare(request.param)


def test_all_readers_read_our_words(result):
    assert result.differences == []


def test_each_reader_read_each_kind_of_file(result):
    kinds = {"Bayer", "X-Trans", "4 x 4", "monochrome"}
    for reader in differential.READERS:
        equal = {
            kind
            for (name, kind, word), count in result.counts.items()
            if name == reader and word == "equal" and count > 0
        }
        assert equal == kinds - {"4 x 4" if reader == "dcraw" else None}, reader


def test_what_is_known_not_to_be_read_is_not_read(result):
    """A limit that is gone is no longer listed."""
    limited = {name for name, _, word in result.counts if word == "limit"}
    assert limited == {reader for reader, *_ in differential.LIMITS}


def test_another_word_is_seen(tmp_path):
    path, _, mosaic = differential.write(tmp_path, 0, 0)
    assert differential.difference("tifffile", path, mosaic) is None
    other = mosaic.copy()
    other[-1, -1] ^= 1
    found = differential.difference("tifffile", path, other)
    assert found == f"1 of {mosaic.size} words differ"
    assert "words, not" in differential.difference("tifffile", path, mosaic[1:])
    path.write_bytes(path.read_bytes()[:100])
    assert differential.difference("tifffile", path, mosaic) is not None


def test_files_are_functions_of_seed_and_number(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    path, case, mosaic = differential.write(tmp_path / "a", 3, 7)
    again, same_case, same = differential.write(tmp_path / "b", 3, 7)
    assert case == same_case and path.read_bytes() == again.read_bytes()
    np.testing.assert_array_equal(mosaic, same)
    assert differential.write(tmp_path / "b", 3, 8)[1] != case
