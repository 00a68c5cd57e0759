# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every command teaches by example, and the examples are command lines of it."""

import re
import shlex

import pytest

from cg2raw.cli import make_parser, subcommands
from python.commands import run


def examples_of(name):
    """Return the words of each example of a command's help."""
    text = subcommands()[name].__doc__.partition("examples:\n")[2]
    lines = text.replace("\\\n", " ").splitlines()
    found = []
    for line in lines:
        line = re.sub(r'^eval "\$\((.*)\)"', r"\1", line.split("#")[0].strip())
        line = line.partition(" | ")[0]
        words = shlex.split(line)
        if words:
            found.append(words[words.index("cg2raw") + 1 :])
    return found


@pytest.mark.parametrize("name", subcommands())
def test_the_help_has_examples_that_parse(name):
    examples = examples_of(name)
    assert 2 <= len(examples) <= 4
    for words in examples:
        assert words[0] == name
        make_parser().parse_args(words)  # raises SystemExit if it is wrong
    shown = run(name, "--help")
    assert shown.code == 0 and "examples:" in shown.out
    assert max(map(len, shown.out.splitlines())) <= 88
