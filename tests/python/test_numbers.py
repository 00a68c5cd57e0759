# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Numbers on a command line: their bounds are legal, all else is refused in words."""

import argparse

import numpy as np
import pytest

from cg2raw.cli._numbers import number, number_list, whole
from cg2raw.cli.convert import shown_seconds, workers_for
from cg2raw.conversion import COUNTED_ROWS, not_finite


@pytest.mark.parametrize(("text", "value"), [("0.5", 0.5), ("9", 9.0), ("1e0", 1.0)])
def test_a_number_reaches_to_its_bounds(text, value):
    assert number(0.5, 9)(text) == value


@pytest.mark.parametrize("text", ["0.49", "9.01", "nan", "inf", "", "1/2"])
def test_other_numbers_are_refused(text):
    with pytest.raises(argparse.ArgumentTypeError) as error:
        number(0.5, 9)(text)
    assert str(error.value) == f"{text}: must be a number from 0.5 to 9"


def test_whole_numbers_have_64_bits_and_no_sign():
    assert [whole(text) for text in ("0", "007", f"{2**64 - 1}")] == [0, 7, 2**64 - 1]
    for text in ("-1", "+1", "1.0", "", " 1", f"{2**64}", "1" * 21, "\u0661"):
        with pytest.raises(argparse.ArgumentTypeError) as error:
            whole(text)
        words = "must be a whole number from 0 to 18446744073709551615"
        assert str(error.value) == f"{text}: {words}"


def test_lists_of_numbers_may_have_a_word():
    assert number_list("--bracket", "-2, 0,2.5") == [-2.0, 0.0, 2.5]
    assert number_list("--iso", "clean,100", "clean") == ["clean", 100.0]
    for words, word, said in (
        ("1,x", "", "--o x: must be a number, as in -2,0,2"),
        ("1,dirty", "clean", "--o dirty: must be a number or clean, as in clean,100"),
        ("1,,2", "", "--o : must be a number"),
        ("2,1,1.0", "", "--o 1.0: is there twice; name it once"),
        ("clean,clean", "clean", "--o clean: is there twice"),
    ):
        with pytest.raises(ValueError) as error:
            number_list("--o", words, word)
        assert str(error.value).startswith(said)


def test_values_that_are_not_finite_are_counted_in_all_rows():
    pixels = np.zeros((2 * COUNTED_ROWS + 3, 4, 3), np.float32)
    assert not_finite(pixels) == (0, 0)
    pixels[[0, COUNTED_ROWS, -1], 1, 2] = np.nan
    pixels[COUNTED_ROWS - 1, 0] = [np.inf, -np.inf, 1.0]
    pixels[-1, 3, 0] = np.inf
    assert not_finite(pixels) == (3, 3)


@pytest.mark.parametrize(
    ("files", "asked", "found"), [(5, 3, 3), (2, 3, 2), (0, 3, 1), (1, None, 1)]
)
def test_no_more_workers_than_files(files, asked, found):
    assert workers_for(files, asked) == found


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(1 / 8000, "1/8000"), (0.25, "1/4"), (0.3, "0.3"), (2.0, "2"), (0.126, "1/8")],
)
def test_exposure_times_are_as_photographers_write_them(seconds, words):
    assert shown_seconds(seconds) == words
