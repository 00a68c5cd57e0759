# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Messages of the command are one line, and short, whatever the words."""

import argparse
from functools import cache

import pytest

from cg2raw import cli
from cg2raw.cli import make_parser
from cg2raw.cli._messages import about_output
from cg2raw.short_messages import about, plural, shortened, words_of
from python.commands import fails
from tiers import slow

LONGEST = 2000  # letters of a message
LONG = "x" * 10**4


def options():
    """Return [command, option] of all options that take a value."""
    commands = make_parser()._subparsers._group_actions[0].choices
    return [
        (name, action.option_strings[-1])
        for name, parser in commands.items()
        for action in parser._actions
        if action.option_strings and action.nargs is None
    ]


@pytest.mark.parametrize(
    "word", ["two\nlines " * 1000, slow(LONG)], ids=["lines", "long"]
)
def test_a_long_word_is_not_repeated(tmp_path, monkeypatch, word):
    monkeypatch.setattr(cli, "make_parser", cache(make_parser))
    places = {"dataset": (tmp_path / "in.exr", tmp_path / "out")}
    for name, option in options():
        words = (name, *places.get(name, ()), option, word)
        if name == "convert":
            words = (name, tmp_path / "in.exr", "-o", tmp_path / "a.dng", *words[1:])
        try:
            line = fails(*words, code=2)
        except AssertionError:  # a word that may be one
            line = fails(*words)
        assert len(line) < LONGEST, (name, option)


def test_beginning_and_end_are_kept():
    message = shortened(f"/place/file: {LONG}: No space left")
    assert message.startswith("/place/file: x") and message.endswith("No space left")
    assert len(message) < LONGEST
    assert words_of(ValueError("a\nb")) == "a b"


@pytest.mark.parametrize(
    ("error", "words", "led"),
    [
        (OSError(28, "No space left", "a.json"), "a.json: No space left", False),
        (OSError(28, "No space left"), "No space left", True),
        (OSError("a.json: is a folder"), "a.json: is a folder", False),
        (MemoryError("std::bad_alloc"), "not enough memory", True),
        (MemoryError("b.exr: std::bad_alloc"), "b.exr: not enough memory", False),
        (ValueError("no\nnumber"), "no number", False),
    ],
    ids=repr,
)
def test_an_error_names_its_file_or_the_output_once(error, words, led):
    assert words_of(error) == about(None, error) == words
    assert about("out", error) == ("out: " if led else "") + words


def test_only_what_is_long_is_cut():
    whole = "x" * 1900
    assert shortened(whole) == whole
    assert shortened(whole + "y").endswith("y") and len(shortened(whole + "y")) < 1900
    assert [plural(n, "dark") for n in range(3)] == ["0 darks", "1 dark", "2 darks"]


def test_what_lacks_memory_is_named():
    arguments = argparse.Namespace(output="/place/a.json")
    assert about_output(arguments, MemoryError()) == "/place/a.json: not enough memory"
    assert about_output(arguments, MemoryError("/b: not enough memory")).startswith(
        "/b: "
    )
    assert about_output(arguments, ValueError("no")) == "no"
    assert about_output(argparse.Namespace(out="out"), MemoryError()).startswith(
        "out: "
    )
    assert about_output(argparse.Namespace(), MemoryError()) == "not enough memory"
