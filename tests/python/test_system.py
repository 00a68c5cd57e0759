# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw.system: the calls of one operating system, which no other module makes."""

import ast
import os
import subprocess
import sys

import pytest

from cg2raw import system

# Of the standard library: what Windows lacks, or macOS, or both.
MODULES = {"fcntl", "msvcrt", "resource", "pwd", "grp", "termios", "selectors"}
NAMES = {
    "O_NOFOLLOW", "O_DIRECTORY", "O_CLOEXEC", "O_BINARY", "O_TMPFILE", "fchmod", "fork",
    "geteuid", "getuid", "killpg", "mkfifo", "process_cpu_count", "sched_getaffinity",
    "setsid", "uname", "wait4", "waitpid",
}  # fmt: skip


def used(path):
    """Yield what a source imports or names of MODULES and NAMES."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in MODULES)
        elif isinstance(node, ast.ImportFrom) and node.module in MODULES:
            yield node.module
        elif isinstance(node, ast.Attribute) and node.attr in NAMES:
            if isinstance(node.value, ast.Name) and node.value.id == "os":
                yield node.attr


def test_other_modules_ask_no_operating_system(repository):
    found = {
        path.relative_to(repository).as_posix(): sorted(set(used(path)))
        for folder in ("python/cg2raw", "ocio/cg2raw_ocio")
        for path in (repository / folder).rglob("*.py")
    }
    own = found.pop("python/cg2raw/system.py")
    assert "fcntl" in own and "sched_getaffinity" in own  # the search finds something
    assert {path: names for path, names in found.items() if names} == {}


def test_cores_are_those_that_the_process_may_use():
    assert 1 <= system.usable_cores() <= os.cpu_count()


@pytest.mark.parametrize("word", ["a/b.json", "/b", "./b", "a/"])
def test_a_word_with_a_folder_is_a_path(word):
    assert system.has_folder(word)


@pytest.mark.parametrize("word", ["nikon-d40", "b.json", "", ".."])
def test_a_bare_name_is_none(word):
    assert not system.has_folder(word)


def test_a_link_is_not_opened(tmp_path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    with pytest.raises(OSError):
        system.open_without_links(tmp_path / "link", os.O_WRONLY | os.O_TRUNC)
    assert (tmp_path / "real").read_bytes() == b"old"
    handle = system.open_without_links(tmp_path / "real", os.O_RDONLY)
    assert os.read(handle, 9) == b"old"
    os.close(handle)


def test_a_locked_file_is_refused_to_another_process_until_it_is_closed(tmp_path):
    path = tmp_path / "lock"
    program = (
        "import sys; from cg2raw import system;"
        " file = open(sys.argv[1], 'r+'); system.lock(file.fileno())"
    )

    def other():
        return subprocess.run(
            [sys.executable, "-c", program, path], capture_output=True, check=False
        ).returncode

    with open(path, "w") as stream:
        system.lock(stream.fileno())
        assert other() != 0
    assert other() == 0


def test_a_pipe_has_no_disk():
    read, write = os.pipe()
    system.sync(write)
    os.close(read)
    os.close(write)


def test_a_process_of_another_parent_ends():
    with pytest.raises(SystemExit):
        system.end_with_parent(os.getppid() + 1)
