# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""DNGs and data sets on the file systems that users mount, with the same bytes."""

import hashlib
import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest

from images import write_image

# {what: shell commands that mount it at $M}; $S is an empty folder beside.
MOUNTS = {
    "overlay": "mkdir $S/a $S/b $S/c; mount -t overlay overlay $M"
    " -o lowerdir=$S/a,upperdir=$S/b,workdir=$S/c",
    "xfs": "truncate -s 320M $S/i; mkfs.xfs -q $S/i; mount -o loop $S/i $M",
    "btrfs": "truncate -s 120M $S/i; mkfs.btrfs -q $S/i; mount -o loop $S/i $M",
    "exfat-fuse": "truncate -s 80M $S/i; mkfs.exfat $S/i;"
    " mount.exfat-fuse $(losetup -f --show $S/i) $M",
    "ntfs-3g": "truncate -s 80M $S/i; mkfs.ntfs -F -q $S/i; ntfs-3g $S/i $M",
    "bindfs": "bindfs $S $M",
    "mergerfs": "mergerfs $S $M",
    "unionfs": "unionfs $S=RW $M",
    "gocryptfs": "gocryptfs -q -init -extpass 'echo x' $S;"
    " gocryptfs -q -extpass 'echo x' $S $M",
    "rclone": "rclone mount :local:$S $M --daemon --vfs-cache-mode writes",
    "sshfs": "socat TCP-LISTEN:$P,fork,reuseaddr EXEC:/usr/lib/openssh/sftp-server &"
    " echo $! > $S.pid; sleep 1; sshfs -o directport=$P localhost:$S $M",
}
PORT = 24680
PROGRAMS = {"xfs": "mkfs.xfs", "btrfs": "mkfs.btrfs", "exfat-fuse": "mount.exfat-fuse"}


def said_by(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{command}: {done.stderr}"
    return done.stdout


@pytest.fixture(params=MOUNTS)
def mounted(request, tmp_path):
    """Return a folder of a file system, or skip the test."""
    kind = request.param
    program = PROGRAMS.get(kind, kind)
    if os.geteuid() != 0 or not (kind == "overlay" or shutil.which(program)):
        pytest.skip(f"needs root and {program}")
    source, folder = tmp_path / "source", tmp_path / "mounted"
    source.mkdir()
    folder.mkdir()
    where = {"S": str(source), "M": str(folder), "P": str(PORT)}
    script = f"set -e; {MOUNTS[kind]}"
    done = subprocess.run(
        ["bash", "-c", script],
        env={**os.environ, **where},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        timeout=60,
    )
    if done.returncode or not os.path.ismount(folder):
        pytest.skip(f"{kind}: does not mount here")
    yield folder
    subprocess.run(["umount", folder], check=True)
    if (source / "i").exists():
        loops = said_by(["losetup", "-j", source / "i", "-O", "NAME", "-n"])
        for loop in loops.split():
            said_by(["losetup", "-d", loop])
    if (tmp_path / "source.pid").exists():
        os.kill(int((tmp_path / "source.pid").read_text()), signal.SIGTERM)


def made(folder, image):
    """Return {file: SHA-256} of what commands, each run twice, leave in a folder."""
    sensor = ["--illuminants", "2", "--sensors", "nikon-d40"]
    for _ in range(2):
        for words in (
            ["convert", image, "-o", folder / "a.dng", "--sensor", "nikon-d40",
             "--illuminant", "D65"],
            ["dataset", image, folder / "dng", *sensor],
            ["dataset", image, folder / "npy", *sensor, "--format", "npy"],
            ["dataset", image, folder / "exr", *sensor, "--format", "exr"],
        ):  # fmt: skip
            said = said_by([sys.executable, "-m", "cg2raw", *words])
    assert "2 of them kept" in said
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).digest()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix in (".dng", ".npy", ".exr")
    }


@pytest.mark.slow
def test_a_file_system_has_the_same_files(mounted, tmp_path):
    image = tmp_path / "in.exr"
    light = np.linspace(0, 1, 96 * 64 * 3, dtype=np.float32).reshape(64, 96, 3)
    write_image(image, light)
    (tmp_path / "own").mkdir()
    (mounted / "own").mkdir()
    expected = made(tmp_path / "own", image)
    assert len(expected) == 7
    assert made(mounted / "own", image) == expected
    names = [path.name for path in (mounted / "own").rglob("*")]
    assert not [name for name in names if name.startswith(".") and name != ".cg2raw"]
