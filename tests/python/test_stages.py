# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Progress of long work: lines where they are asked for, a bar on a terminal alone."""

import io
import re
import sys

import pytest

from cg2raw.cli._progress import bar, counted, stages, tracked


class Terminal(io.StringIO):
    """A standard error that is a terminal without a file of the system's."""

    encoding = "utf-8"

    def isatty(self):
        return True


def terminal(monkeypatch):
    """Return what standard error is from now on; in a fixture pytest would undo it."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", Terminal())
    return sys.stderr


def work(progress):
    for words, share in (("reading", 0.0), ("reading", 0.5), ("fitting", 0.5)):
        progress(words, share)


@pytest.mark.parametrize(
    ("verbose", "line"), [(1, ""), (2, r" {1,7}\d+\.\d s  ")], ids=["words", "times"]
)
def test_each_stage_is_a_line_once(capsys, verbose, line):
    with stages(verbose=verbose) as progress:
        work(progress)
    pattern = f"{line}reading\n{line}fitting\n"
    assert re.fullmatch(pattern, capsys.readouterr().err)


@pytest.mark.parametrize("quiet", [False, True])
def test_a_pipe_gets_no_progress(capsys, quiet):
    with stages(quiet=quiet) as progress, counted("files", "files", 3) as done:
        work(progress)
        done(3)
    assert list(tracked([1, 2, 3], "converting", quiet)) == [1, 2, 3]
    assert capsys.readouterr() == ("", "")


def test_a_terminal_has_a_bar_that_goes_again(monkeypatch):
    shown = terminal(monkeypatch)
    with stages() as progress:
        work(progress)
        progress("fitting", 0.25)
    with counted("making", "files", 8) as done:
        done(2)
    assert list(tracked("ab", "converting")) == ["a", "b"]
    with bar("adding", 4) as update:
        update(1)
    for word in ("left", "making", "/8", "files,", "adding"):
        assert word in shown.getvalue()
    assert shown.getvalue().endswith("\x1b[2K")  # its line is wiped out


def test_quiet_work_and_a_single_file_have_no_bar(monkeypatch):
    shown = terminal(monkeypatch)
    with stages(quiet=True) as progress:
        work(progress)
    assert list(tracked("a", "converting")) == ["a"]
    assert list(tracked("ab", "converting", quiet=True)) == ["a", "b"]
    assert shown.getvalue() == ""
