# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ten thousand images cost the command no more memory than a quarter of them."""

import os
import subprocess
import sys

import pytest

from dataset.data_sets import rows, scene, write_image

pytestmark = pytest.mark.slow
OPTIONS = "--sensors nikon-d40 --illuminants 1 --format npy --type uint16".split()


# VmHWM, not ru_maxrss, which a process inherits from the one that started it. Row
# groups are small, since two of them are in memory.
PROGRAM = """
import re, sys
from cg2raw.cli import main
from cg2raw.dataset import manifest
manifest.ROWS = 512
code = main(sys.argv[1:])
print(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])
sys.exit(code)
"""


def peak_of(images, out):
    """Return the peak memory of the command itself, not of its workers, MB."""
    words = ["dataset", images, out, *OPTIONS, "--crop", "64x64", "--quiet"]
    command = [sys.executable, "-c", PROGRAM, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return int(done.stdout) / 1024


def test_memory_does_not_grow_with_the_number_of_images(tmp_path):
    sources = [
        write_image(tmp_path / f"{number}.exr", scene((384, 512), number))
        for number in range(4)
    ]
    peaks = {}
    for count in (2500, 10000):
        folder = tmp_path / f"in{count}"
        folder.mkdir()
        for number in range(count):
            os.link(sources[number % 4], folder / f"{number}.exr")
        peaks[count] = peak_of(folder, tmp_path / f"out{count}")
    assert len(rows(tmp_path / "out10000")) == 10000
    print(peaks)
    # Measured: 3.3 MB, the names of one folder, sorted. Rows kept would be 20 MB.
    assert peaks[10000] < peaks[2500] + 6, peaks
