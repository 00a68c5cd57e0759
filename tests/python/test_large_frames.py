# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Memory that writing a DNG takes beside the host's rows: the same for any height."""

import subprocess
import sys
from pathlib import Path

import pytest
import tifffile

WIDTH, STRIP = 10000, 64
# The peak is set back first: VmHWM, unlike ru_maxrss, can be.
PROGRAM = f"""
import re, sys
import numpy as np
import OpenImageIO as oiio
import cg2raw

def peak():
    return int(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])

cg2raw.register_oiio_plugin()
path, compression, height = sys.argv[1], sys.argv[2], int(sys.argv[3])
random = np.random.default_rng(1)
rows = random.uniform(0, 1, ({STRIP}, {WIDTH}, 3)).astype(np.float16)
spec = oiio.ImageSpec({WIDTH}, height, 3, "half")
asked = {{"sensor": "sony-a7s-ii", "illuminant": "D65", "iso": 3200, "seed": 1}}
for name, value in asked.items():
    spec.attribute("dng:" + name, value)
spec.attribute("dng:compression", compression)
open("/proc/self/clear_refs", "w").write("5")
before = peak()
output = oiio.ImageOutput.create(path)
assert output.open(path, spec), output.geterror()
for first in range(0, height, {STRIP}):
    count = min({STRIP}, height - first)
    assert output.write_scanlines(first, first + count, 0, rows[:count])
assert output.close(), output.geterror()
print((peak() - before) / 1024)
"""


@pytest.mark.skipif(
    not Path("/proc/self/clear_refs").exists(), reason="asks Linux's /proc"
)
@pytest.mark.parametrize("compression", ["none", "ljpeg"])
@pytest.mark.parametrize(
    "megapixels",
    [
        30,
        pytest.param(200, marks=pytest.mark.slow),
        pytest.param(500, marks=pytest.mark.slow),
    ],
)
def test_memory_of_frames_by_scanlines(wheel_plugin, megapixels, compression, tmp_path):
    path, height = tmp_path / "large.dng", megapixels * 10**6 // WIDTH
    command = [sys.executable, "-c", PROGRAM, path, compression, str(height)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert float(done.stdout) < 12, f"{done.stdout} MB"
    with tifffile.TiffFile(path) as file:
        raw = file.pages[0].pages[0]  # the preview is the first
        assert raw.shape == (height, WIDTH)
    path.unlink()
