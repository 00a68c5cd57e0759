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
    text = path.read_text()
    if not any(name in text for name in MODULES | NAMES):
        return
    for node in ast.walk(ast.parse(text)):
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


@pytest.fixture
def tree(tmp_path):
    """Return a folder a/b with files, and links from it to another one."""
    (tmp_path / "a/b").mkdir(parents=True)
    (tmp_path / "a/b/file").write_bytes(b"ours")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/file").write_bytes(b"theirs")
    (tmp_path / "a/link").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "a/b/link").symlink_to(tmp_path / "elsewhere/file")
    return tmp_path


def test_a_folder_is_reached_without_following_a_link(tree):
    with pytest.raises(OSError, match=r"/a/link: is a link, which is not ours; remove"):
        system.Folder(str(tree), "a/link")
    with pytest.raises(OSError, match=r"/a/link: is a link, which is not ours; remove"):
        system.Folder(str(tree), "a/link/new", make=True)
    assert [path.name for path in (tree / "elsewhere").iterdir()] == ["file"]
    for below in ("..", "a/../../b", "/tmp"):
        with pytest.raises(OSError, match="is not below"):
            system.Folder(str(tree), below)
    with pytest.raises(FileNotFoundError):
        system.Folder(str(tree), "a/c")
    with pytest.raises(NotADirectoryError):
        system.Folder(str(tree), "a/b/file", make=True)
    with system.Folder(str(tree), "a/c/d", make=True) as folder:
        assert folder.path == str(tree / "a/c/d") and folder.names() == []


def test_files_in_a_folder_are_no_links(tree):
    with system.Folder(str(tree), "a/b") as folder:
        assert folder.names() == ["file", "link"]
        for flags in (os.O_RDONLY, os.O_WRONLY | os.O_TRUNC, os.O_RDWR | os.O_CREAT):
            with pytest.raises(OSError, match="/b/link: is a link, which is not ours"):
                folder.open("link", flags)
        os.mkfifo(tree / "a/b/pipe")
        with pytest.raises(OSError, match="/b/pipe: is no regular file"):
            folder.open("pipe", os.O_RDONLY)  # not: wait for who writes to it
        folder.replace("file", folder, "link")
        assert (tree / "a/b/link").read_bytes() == b"ours"
        folder.remove("link")
        assert folder.names() == ["pipe"]
    assert (tree / "elsewhere/file").read_bytes() == b"theirs"


def test_a_folder_stays_the_one_that_was_opened(tree):
    """A stranger who swaps it for a link while we work gains nothing."""
    with system.Folder(str(tree), "a/b") as folder:
        (tree / "a/b").rename(tree / "a/moved")
        (tree / "a/b").symlink_to(tree / "elsewhere")
        handle = folder.open("new", os.O_WRONLY | os.O_CREAT | os.O_EXCL)
        os.close(handle)
        folder.remove("file")
    assert (tree / "elsewhere/file").read_bytes() == b"theirs"
    assert not (tree / "elsewhere/new").exists() and (tree / "a/moved/new").exists()


def test_a_path_leads_into_the_folder_that_was_opened(tree):
    with system.Folder(str(tree), "a/b") as folder:
        (tree / "a/b").rename(tree / "a/moved")
        (tree / "a/b").symlink_to(tree / "elsewhere")
        with folder.path_for("new") as path, open(path, "wb") as stream:
            stream.write(b"ours")
    assert [path.name for path in (tree / "elsewhere").iterdir()] == ["file"]
    assert (tree / "a/moved/new").read_bytes() == b"ours"


@pytest.mark.parametrize("kind", [OSError, ValueError, MemoryError])
def test_what_is_said_of_such_a_path_is_said_of_its_own(tree, kind):
    own = str(tree / "a/b/new")
    with system.Folder(str(tree), "a/b") as folder:
        with (
            pytest.raises(kind, match=f"{own}: too long"),
            folder.path_for("new") as path,
        ):
            raise kind(f"{path}: too long")
        with pytest.raises(FileExistsError) as raised, folder.path_for("file") as path:
            os.mkdir(path)
    assert raised.value.filename == str(tree / "a/b/file")


def test_what_fails_to_open_leaves_no_descriptor(tree):
    before = len(os.listdir("/proc/self/fd"))
    for below in ("a/link", "a/c", "..", "a/b/file"):
        with pytest.raises(OSError):
            system.Folder(str(tree), below)
    os.mkfifo(tree / "a/b/pipe")
    with system.Folder(str(tree), "a/b") as folder, pytest.raises(OSError):
        folder.open("pipe", os.O_RDONLY)
    assert len(os.listdir("/proc/self/fd")) == before


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


def test_a_process_of_another_parent_ends():
    with pytest.raises(SystemExit):
        system.end_with_parent(os.getppid() + 1)


def test_children_leave_ctrl_c_to_their_parent():
    program = "import os, signal; os.kill(os.getpid(), signal.SIGINT); print('lives')"
    child = [sys.executable, "-c", program]
    with system.children_without_ctrl_c():
        done = subprocess.run(child, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "lives\n", "")
    done = subprocess.run(child, capture_output=True, text=True)
    assert done.returncode != 0 and "KeyboardInterrupt" in done.stderr
