# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every command teaches by example, and the examples are command lines of it."""

import re
import shlex

import pytest

from cg2raw.cli import make_parser
from python.commands import run


def commands_of(parser):
    """Return {words: parser} of the commands of a parser, and of theirs."""
    found = {}
    for action in parser._actions:
        if action.dest == "==SUPPRESS==":
            for name, command in action.choices.items():
                found[name,] = command
                found |= {(name, *w): c for w, c in commands_of(command).items()}
    return found


COMMANDS = commands_of(make_parser())


def examples_of(name):
    """Return the words of each example of a command's help."""
    text = COMMANDS[name].description.partition("examples:\n")[2]
    lines = text.replace("\\\n", " ").splitlines()
    found = []
    for line in lines:
        line = re.sub(r'^eval "\$\((.*)\)"', r"\1", line.split("#")[0].strip())
        line = line.partition(" | ")[0]
        words = shlex.split(line)
        if words:
            found.append(words[words.index("cg2raw") + 1 :])
    return found


@pytest.mark.parametrize("name", COMMANDS, ids=" ".join)
def test_the_help_has_examples_that_parse(name):
    examples = examples_of(name)
    assert 2 <= len(examples) <= 4
    for words in examples:
        assert tuple(words[: len(name)]) == name
        make_parser().parse_args(words)  # raises SystemExit if it is wrong
    shown = run(*name, "--help")
    assert shown.code == 0 and "examples:" in shown.out
    assert max(map(len, shown.out.splitlines())) <= 88
