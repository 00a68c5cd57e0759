# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A DNG is complete under its name, or absent, whatever happens."""

import os
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from conftest import mounted
from images import attributes, read_dn, write_image

S20 = attributes(sensor="samsung-s20fe", illuminant="D65")


@pytest.fixture(params=["none", "ljpeg"])
def compression(request):
    """Return arguments of each compression."""
    return attributes(compression=request.param)


def test_full_disk(oiiotool, exr, tmp_path, compression):
    with mounted(tmp_path / "small", "-o", "size=12k") as folder:
        out = folder / "shot.dng"
        done = oiiotool(exr, *S20, *compression, "-o", out, check=False)
        assert done.returncode != 0
        assert "No space left" in done.stdout + done.stderr
        assert list(folder.iterdir()) == []


def test_read_only_folder(oiiotool, exr, tmp_path, compression):
    with mounted(tmp_path / "fixed", "-o", "ro") as folder:
        done = oiiotool(exr, *S20, *compression, "-o", folder / "a.dng", check=False)
        assert done.returncode != 0
        assert "Read-only file system" in done.stdout + done.stderr


def test_folder_that_is_not_there(oiiotool, exr, tmp_path):
    done = oiiotool(exr, *S20, "-o", tmp_path / "no" / "a.dng", check=False)
    assert done.returncode != 0
    message = done.stdout + done.stderr  # OpenImageIO 3 looks before we do
    assert "No such file" in message or "Non-existent output directory" in message


def limit_file_size():
    """Let no file grow beyond 16 kB; a write fails instead of killing the process."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (16384, 16384))


def test_file_size_limit(oiiotool, exr, tmp_path, compression):
    out = tmp_path / "shot.dng"
    done = oiiotool(
        exr, *S20, *compression, "-o", out, check=False, preexec_fn=limit_file_size
    )
    assert done.returncode != 0
    # The wheel's launcher gives the signal its deadly meaning back: nothing is said.
    killed = oiiotool.name == "oiio-wheel" and not done.stderr
    assert killed or "File too large" in done.stdout + done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["scene.exr"]


WRITER = """
import sys
import numpy as np
import OpenImageIO as oiio
spec = oiio.ImageSpec(512, 60000, 3, "float")
spec.attribute("dng:sensor", "nikon-d40")
spec.attribute("dng:illuminant", "D65")
spec.attribute("dng:compression", sys.argv[2])
spec.attribute("dng:preview", 0)
output = oiio.ImageOutput.create(sys.argv[1])
assert output.open(sys.argv[1], spec), output.geterror()
rows = np.random.default_rng(1).random((64, 512, 3), dtype=np.float32)
for y in range(0, 50000, 64):
    assert output.write_scanlines(y, y + 64, 0, rows), output.geterror()
    print(y, flush=True)
"""


@pytest.mark.parametrize("kind", ["none", "ljpeg"])
def test_kill_while_writing(tmp_path, repository, kind):
    plugins = repository / "build/wheel/lib/cg2raw/oiio"
    if not (plugins / "dng.imageio.so").exists():
        pytest.skip("no plugin for the OpenImageIO wheel: run scripts/setup")
    environment = {**os.environ, "OPENIMAGEIO_PLUGIN_PATH": str(plugins)}
    out = tmp_path / "shot.dng"
    command = [sys.executable, "-c", WRITER, out, kind]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as process:
        for _ in range(20):
            assert process.stdout.readline()
        process.send_signal(signal.SIGKILL)
    time.sleep(0.1)
    assert list(tmp_path.iterdir()) == []


def test_an_old_file_survives_a_failure(oiiotool, exr, tmp_path):
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, "-o", out)
    before = out.read_bytes()
    done = oiiotool(exr, *S20, *attributes(iso=10**7), "-o", out, check=False)
    assert done.returncode != 0
    assert out.read_bytes() == before
    oiiotool(exr, *S20, *attributes(iso=800), "-o", out)
    assert out.read_bytes() != before


def test_names_that_are_no_ascii(oiiotool, exr, tmp_path):
    out = tmp_path / "ein Bild \u2013 \u00e4\u65e5.dng"
    oiiotool(exr, *S20, "-o", out)
    assert read_dn(out).shape == (96, 128)


@pytest.mark.parametrize("size", [(1, 1), (1, 64), (64, 1), (2, 2), (3, 5), (17, 33)])
def test_tiny_images_are_written_or_refused(oiiotool, tmp_path, size):
    exr = write_image(tmp_path / "in.exr", np.full((*size, 3), 0.5, np.float32))
    out = tmp_path / "shot.dng"
    done = oiiotool(exr, *S20, "-o", out, check=False)
    if min(size) < 2:
        assert done.returncode != 0
        assert "2" in done.stdout + done.stderr
        assert not out.exists()
    else:
        assert done.returncode == 0, done.stdout + done.stderr
        assert out.exists()
