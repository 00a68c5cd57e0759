# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""io/atomic_file.py: permissions, links and temporary names of files and folders.

What happens when a call fails is in tests/faults/test_publish.py."""

import os
import re
import secrets

import pytest

from cg2raw.io import atomic_file
from cg2raw.io.atomic_file import write_atomically, write_folder, write_with_folder


@pytest.fixture
def umask():
    """Set one that takes from group and others, as a cautious user does."""
    before = os.umask(0o027)
    yield
    os.umask(before)


def mode(path):
    return path.stat().st_mode & 0o7777


@pytest.mark.parametrize("bits", [0o600, 0o640, 0o664, 0o666, 0o777])
def test_an_older_file_keeps_its_permissions(tmp_path, umask, bits):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(bits)
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new" and mode(path) == bits


def test_a_new_file_has_what_the_umask_leaves(tmp_path, umask, monkeypatch):
    """Without a moment in which the umask of the whole process is another one."""
    asked = []
    monkeypatch.setattr(os, "umask", asked.append)
    write_atomically(tmp_path / "file", b"new")
    assert mode(tmp_path / "file") == 0o640 and asked == []


def test_a_set_user_id_is_not_given_to_other_bytes(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"old")
    path.chmod(0o4755)
    write_atomically(path, b"new")
    assert mode(path) == 0o755


def test_an_older_folder_keeps_its_permissions(tmp_path, umask):
    folder = tmp_path / "folder"
    write_folder(folder, {"a": b"old"}, lambda name: True)
    assert mode(folder) == 0o750
    folder.chmod(0o775)
    write_folder(folder, {"a": b"new"}, lambda name: True)
    assert mode(folder) == 0o775 and (folder / "a").read_bytes() == b"new"


def test_a_link_stays_one_and_its_file_is_written(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/file").write_bytes(b"old")
    (tmp_path / "link").symlink_to("sub/file")
    (tmp_path / "later").symlink_to("sub/new")  # which leads to no file yet
    for name, target in (("link", "sub/file"), ("later", "sub/new")):
        write_atomically(tmp_path / name, b"new")
        assert (tmp_path / name).is_symlink()
        assert (tmp_path / target).read_bytes() == b"new"
    assert sorted(os.listdir(tmp_path / "sub")) == ["file", "new"]


def test_links_in_a_circle_are_refused(tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    says = re.escape(f"{tmp_path / 'a'}: cannot be written: its links lead in a circle")
    with pytest.raises(OSError, match=f"^{says}$"):
        write_atomically(tmp_path / "a", b"new")
    assert sorted(os.listdir(tmp_path)) == ["a", "b"] and (tmp_path / "a").is_symlink()


def test_a_temporary_name_that_is_taken_is_not_the_last(tmp_path, monkeypatch):
    """Also by a link, which is not followed."""
    letters = iter("a" * 8 + "b" * 8 + "c" * 8)
    monkeypatch.setattr(secrets, "choice", lambda _: next(letters))
    precious = tmp_path / "precious"
    precious.write_bytes(b"do not lose this")
    (tmp_path / f".file.{'a' * 8}").write_bytes(b"a stranger's")
    (tmp_path / f".file.{'b' * 8}").symlink_to(precious)
    write_atomically(tmp_path / "file", b"new")
    assert (tmp_path / "file").read_bytes() == b"new"
    assert precious.read_bytes() == b"do not lose this"
    assert len(os.listdir(tmp_path)) == 4  # and no other one


def test_tries_come_to_an_end(tmp_path, monkeypatch):
    monkeypatch.setattr(secrets, "choice", lambda _: "a")
    (tmp_path / f".file.{'a' * 8}").touch()
    with pytest.raises(OSError, match=f"^{tmp_path}/file: cannot be written: File exi"):
        write_atomically(tmp_path / "file", b"new")
    assert os.listdir(tmp_path) == [f".file.{'a' * 8}"]


def test_temporary_names_are_not_foreseen(tmp_path):
    """36^8 names: two of 50 share the first five letters in one of 50,000 runs."""
    with atomic_file.Folder(str(tmp_path)) as folder:
        for _ in range(50):
            handle, _name = atomic_file.new_file(folder, "file")
            os.close(handle)
    assert len({name[6:11] for name in os.listdir(tmp_path)}) == 50


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
    with pytest.raises(OSError, match="cannot be written: File name too long"):
        write_with_folder(folder / ("n" * 300), b"new")
    assert [path.name for path in folder.iterdir()] == ["file"]
    with pytest.raises(OSError, match="cannot be written: File name too long"):
        write_with_folder(tmp_path / "other" / ("n" * 300), b"new")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]
