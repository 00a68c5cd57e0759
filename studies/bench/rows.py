# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure data sets of very many small files: making and resuming them, and memory."""

import os
import shutil
import subprocess
import sys
import time

IMAGES = 200
# VmHWM of the command alone, not of its workers
PROGRAM = """
import re, sys
from cg2raw.cli import main
code = main(sys.argv[1:])
print(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])
sys.exit(code)
"""


def run(images, out, rows):
    """Run the command; return (seconds, its peak memory in MB)."""
    words = f"--sensors nikon-d40 --illuminants {rows // IMAGES} --crop 16x16"
    words += " --format npy --type uint16 --quiet"
    command = [sys.executable, "-c", PROGRAM, "dataset", images, out, *words.split()]
    begin = time.perf_counter()
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return time.perf_counter() - begin, int(done.stdout) / 1024


def bench(source, folder, rows):
    """Make a data set of @rows rows of one EXR's crops, resume it, and remove it."""
    images, out = folder / "few", folder / f"rows{rows}"
    shutil.rmtree(out, ignore_errors=True)
    images.mkdir(parents=True, exist_ok=True)
    for number in range(IMAGES):
        if not (images / f"{number}.exr").exists():
            os.link(source, images / f"{number}.exr")
    print(f"\n{rows} rows of {IMAGES} images, workers as many as cores")
    for name in ("made", "resumed"):
        seconds, peak = run(images, out, rows)
        print(
            f"{name:8}{seconds:8.1f} s {rows / seconds:9.0f} rows/s, the command "
            f"itself at most {peak:.0f} MB"
        )
    shutil.rmtree(out)
