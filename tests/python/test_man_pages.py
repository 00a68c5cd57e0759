# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Manual pages: one of each command, and man prints them."""

import subprocess

import pytest

from cg2raw.cli import make_parser


def pages(parser, name="cg2raw"):
    """Yield the page of a parser and of each of its commands, with the parser."""
    yield name, parser
    for action in parser._actions:
        if action.dest == "==SUPPRESS==":
            for word, command in action.choices.items():
                yield from pages(command, f"{name}-{word}")


PAGES = dict(pages(make_parser()))


@pytest.mark.parametrize("name", PAGES)
def test_man_prints_it(program, repository, name):
    page = repository / "docs" / "man" / f"{name}.1"
    done = subprocess.run(
        [program("man"), "--warnings", "--local-file", page],
        capture_output=True,
        text=True,
        env={"MANWIDTH": "80", "LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "NAME" in done.stdout and "SYNOPSIS" in done.stdout


@pytest.mark.parametrize("name", PAGES)
def test_every_option_is_there(repository, name):
    text = (repository / "docs" / "man" / f"{name}.1").read_text()
    for action in PAGES[name]._actions:
        for option in action.option_strings:
            assert option.replace("-", "\\-") in text
