# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""io/atomic_file.py: permissions, links and temporary names of files and folders.

What happens when a call fails is in tests/faults/test_publish.py."""

import os

import pytest

from cg2raw.io import atomic_file
from cg2raw.io.atomic_file import (
    write_atomically,
    write_folder,
    write_in,
    write_with_folder,
)
from cg2raw.system import Folder


@pytest.fixture
def umask():
    """Set one that takes from group and others, as a cautious user does."""
    before = os.umask(0o027)
    yield
    os.umask(before)


def mode(path):
    return path.stat().st_mode & 0o7777


def test_an_older_folder_keeps_its_permissions(tmp_path, umask):
    folder = tmp_path / "folder"
    write_folder(folder, {"a": b"old"}, lambda name: True)
    assert mode(folder) == 0o750
    folder.chmod(0o775)
    write_folder(folder, {"a": b"new"}, lambda name: True)
    assert mode(folder) == 0o775 and (folder / "a").read_bytes() == b"new"


def test_a_folder_is_replaced_only_if_all_in_it_is_ours(tmp_path):
    folder, file = tmp_path / "folder", tmp_path / "file"
    file.write_bytes(b"mine")
    folder.mkdir()
    (folder / "a.ctf").write_bytes(b"old")
    (folder / "notes.txt").write_bytes(b"mine")
    files = {"b.ctf": b"new"}
    for path, words in (
        (file, "file: is there already and no folder; remove it"),
        (folder, "folder: holds notes.txt, which is not ours; remove it"),
    ):
        with pytest.raises(ValueError, match=words):
            write_folder(path, files, lambda name: name.endswith(".ctf"))
    assert file.read_bytes() == b"mine"
    assert sorted(path.name for path in folder.iterdir()) == ["a.ctf", "notes.txt"]
    (folder / "notes.txt").unlink()
    write_folder(folder, files, lambda name: name.endswith(".ctf"))
    assert [path.name for path in folder.iterdir()] == ["b.ctf"]


def test_a_link_stays_one_and_its_file_is_written(tmp_path, umask):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/file").write_bytes(b"old")
    (tmp_path / "sub/file").chmod(0o666)
    (tmp_path / "link").symlink_to("sub/file")
    write_atomically(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "sub/file").read_bytes() == b"new"
    assert mode(tmp_path / "sub/file") == 0o666
    with Folder(str(tmp_path)) as folder:
        write_in(folder, "link", b"newer", "said")
    assert not (tmp_path / "link").is_symlink()
    assert (tmp_path / "link").read_bytes() == b"newer"
    assert (tmp_path / "sub/file").read_bytes() == b"new"


def test_an_error_is_the_cores_and_names_the_path(tmp_path):
    """Also one that is not UTF-8, which is written as any other."""
    path = f"{tmp_path}/\udcff"
    write_atomically(path, b"new")
    assert os.listdir(os.fsencode(tmp_path)) == [b"\xff"]
    os.unlink(path)
    os.mkdir(path)
    with pytest.raises(OSError, match=r"^/.*/\?: is not a regular file: choose"):
        write_atomically(path, b"new")
    os.rmdir(path)
    os.symlink("a", tmp_path / "a")
    with pytest.raises(OSError, match=f"^{tmp_path}/a: cannot create: Too many levels"):
        write_atomically(tmp_path / "a", b"new")
    with (
        Folder(str(tmp_path)) as folder,
        pytest.raises(OSError, match="^said: cannot create: File name too long$"),
    ):
        write_in(folder, "n" * 300, b"new", "said")
    assert os.listdir(tmp_path) == ["a"] and os.path.islink(tmp_path / "a")


def test_nothing_is_left_where_no_folder_can_be_opened(tmp_path, monkeypatch):
    """As shutil.rmtree needs to be, and a process with too many files cannot."""
    place = tmp_path / "place"
    write_folder(place, {"a.txt": b"old"}, lambda name: True)
    (place / "inner").mkdir()
    (place / "inner/b.txt").write_bytes(b"old")
    monkeypatch.setattr(atomic_file.shutil, "rmtree", lambda *_, **__: None)
    write_folder(place, {"a.txt": b"new"}, lambda name: True)
    assert (place / "a.txt").read_bytes() == b"new"
    assert [path.name for path in tmp_path.rglob("*")] == ["place", "a.txt"]


def test_a_folder_that_was_made_for_a_file_goes_with_it(tmp_path):
    folder = tmp_path / "folder"
    write_with_folder(folder / "file", b"new")
    assert (folder / "file").read_bytes() == b"new"
    with pytest.raises(OSError, match="cannot create: File name too long"):
        write_with_folder(folder / ("n" * 300), b"new")
    assert [path.name for path in folder.iterdir()] == ["file"]
    with pytest.raises(OSError, match="cannot create: File name too long"):
        write_with_folder(tmp_path / "other" / ("n" * 300), b"new")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]
