# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""SECURITY.md: what is promised is tested, and by tests that are there."""

import re

import pytest

HEADING = "## What is promised, and the test of it"
TEST = re.compile(r"`(tests/[\w/]+\.(?:py|cpp))::([\w.]+)`")
DEFINED = {
    "py": r"^def {0}\(",
    "cpp": r"^TEST(?:_[FP])?\(\s*{0},\s*{1}\)",  # suite, test
}


@pytest.fixture
def promises(repository):
    """Return the items of the list, as texts."""
    text = (repository / "SECURITY.md").read_text().partition(HEADING)[2]
    return re.findall(r"^- (.+?)(?=^- |^$)", text.partition("\n## ")[0], re.M | re.S)


def is_there(repository, path, name):
    """Return whether a source of tests defines one of a name."""
    suite, _, test = name.partition(".")
    pattern = DEFINED[path.rpartition(".")[2]].format(suite, test)
    source = repository / path
    return source.exists() and re.search(pattern, source.read_text(), re.M) is not None


def test_each_promise_names_its_tests(promises):
    assert len(promises) > 12
    assert [promise for promise in promises if not TEST.search(promise)] == []


def test_the_tests_are_there(promises, repository):
    named = [found for promise in promises for found in TEST.findall(promise)]
    assert [pair for pair in named if not is_there(repository, *pair)] == []
    # All that is quoted with "::" is understood.
    assert "".join(promises).count("::") == len(named)


def test_a_test_that_is_gone_is_seen(repository):
    here = "tests/test_security.py"
    assert is_there(repository, here, "test_the_tests_are_there")
    assert not is_there(repository, here, "test_the_tests")
    assert not is_there(repository, "tests/test_gone.py", "test_the_tests_are_there")
    posix = "tests/dng/tiff/atomic_file_posix_test.cpp"
    assert is_there(repository, posix, "PosixAtomicFiles.RefuseWhatIsNoFile")
    assert not is_there(repository, posix, "PosixAtomicFiles.KeepTheModeOfAFile")
