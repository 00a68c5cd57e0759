# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""File systems that lack a call: FAT, FUSE, Lustre without locks, shares."""

import errno
import os
import subprocess
import sys

import numpy as np
import pytest

from faults.injector import Injector
from images import write_image
from tiers import first_fast

# What such file systems answer: FUSE ENOSYS; Lustre without the mount option
# flock, ENOSYS; NFS without lockd ENOLCK; Samba's folders EINVAL; shares ENOTSUP.
LACKING = [
    ("fchmod", errno.EPERM), ("fsync", errno.EINVAL),
    ("fchmod", errno.ENOTSUP), ("fchmod", errno.ENOSYS),
    ("fsync", errno.ENOTSUP), ("fsync", errno.ENOSYS),
]  # fmt: skip
NO_LOCKS = [errno.ENOSYS, errno.ENOLCK, errno.ENOTSUP]
CONVERT = ["convert", "a.exr", "-o", "out/a.dng", "--illuminant", "D65"]
DATASET = ["dataset", "a.exr", "out/set", "--illuminants", "1", "--format", "npy"]


@pytest.fixture
def injector(library, tmp_path):
    write_image(tmp_path / "a.exr", np.full((16, 16, 3), 0.4, np.float32))
    (tmp_path / "out").mkdir()
    return Injector(library, tmp_path / "out", tmp_path)


def run(command, folder, **faults):
    """Return the finished command, which says all that it has to say."""
    sensor = ["--sensor" if command[0] == "convert" else "--sensors", "nikon-d40"]
    return subprocess.run(
        [sys.executable, "-m", "cg2raw", *command, *sensor],
        cwd=folder,
        env={**os.environ, **faults},
        capture_output=True,
        text=True,
    )


def older_file(folder):
    """Return the path of a DNG, of which more is kept than the umask leaves: fchmod."""
    path = folder / "out/a.dng"
    path.write_bytes(b"old")
    path.chmod(0o666)
    return path


@pytest.mark.parametrize("call, number", first_fast(LACKING, 2))
def test_what_a_file_system_lacks_is_done_without(injector, tmp_path, call, number):
    faults = injector.environment(call, number, sticky=True, tmpfile=False)
    path = older_file(tmp_path)
    done = run(CONVERT, tmp_path, **faults)
    assert (done.returncode, done.stderr) == (0, "")
    assert injector.fired
    assert path.read_bytes()[:4] == b"II*\0"


@pytest.mark.parametrize("number", first_fast(NO_LOCKS, 1))
def test_a_data_set_is_made_without_locks(injector, tmp_path, number):
    faults = injector.environment("flock", number, sticky=True)
    for _ in range(2):
        done = run(DATASET, tmp_path, **faults)
        assert done.returncode == 0, done.stderr
    assert injector.fired
    assert "wrote" in done.stdout and "1 of them kept" in done.stdout
    assert done.stderr.splitlines() == [
        f"cg2raw dataset: {tmp_path}/out/set: its file system has no locks: see "
        "that no other cg2raw writes there"
    ]


@pytest.mark.parametrize("call", ["fchmod", "fsync"])
def test_other_errors_are_errors(injector, tmp_path, call):
    path = older_file(tmp_path)
    faults = injector.environment(call, errno.EIO, sticky=True, tmpfile=False)
    done = run(CONVERT, tmp_path, **faults)
    assert done.returncode == 1 and "Input/output error" in done.stderr
    assert path.read_bytes() == b"old"


def test_a_lock_that_another_has_is_an_error(injector, tmp_path):
    faults = injector.environment("flock", errno.EWOULDBLOCK, sticky=True)
    done = run(DATASET, tmp_path, **faults)
    assert done.returncode == 1 and "another cg2raw" in done.stderr
