# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure whole oiiotool processes on a 12-MP half-float EXR.

Every round runs each command once, the peer among them, so that whatever else the
machine does meets them all alike; a ratio is that of medians."""

import os
import statistics
import subprocess
import time
from pathlib import Path

from studies.bench import ocio
from studies.places import ROOT

FOLDER = ROOT / "out" / "bench"
OIIOTOOLS = (Path("/usr/bin/oiiotool"), ROOT / ".venv/bin/oiiotool")
WIDTH, HEIGHT = 4032, 3024
SENSOR = ["--attrib", "dng:sensor", "samsung-s20fe"]
LIGHT = ["--attrib", "dng:illuminant", "2856K"]
PLAIN = ["--attrib", "dng:compression", "none"]
PEER = "16-bit TIFF (peer)"
TIFF = ["-d", "uint16", "--compression", "none"]
# As in a studio, where $OCIO names a config of many spaces; all else is without one.
WITH_CONFIG = " with $OCIO"
FLOOR = "no file (floor)"  # oiiotool alone: what no writer can go below
COMMANDS = {
    FLOOR: ([], "null"),
    PEER: (TIFF, "tif"),
    "DNG": ([*SENSOR, *LIGHT, *PLAIN], "dng"),
    "DNG, ISO 3200": ([*SENSOR, *LIGHT, *PLAIN, "--attrib", "dng:iso", "3200"], "dng"),
    "DNG, ljpeg": ([*SENSOR, *LIGHT], "dng"),
    "DNG, ljpeg-2d": (
        [*SENSOR, *LIGHT, "--attrib", "dng:compression", "ljpeg-2d"],
        "dng",
    ),
    ocio.WHOLE: (["--tocolorspace", ocio.SPACE, *PLAIN], "dng"),
    "DNG, ljpeg, ISO 3200": ([*SENSOR, *LIGHT, "--attrib", "dng:iso", "3200"], "dng"),
    PEER + WITH_CONFIG: (TIFF, "tif"),
    "DNG" + WITH_CONFIG: ([*SENSOR, *LIGHT, *PLAIN], "dng"),
}
BOUNDS = {
    "DNG": 0.9,
    "DNG, ISO 3200": 1.0,
    "DNG, ljpeg": 1.5,
    ocio.WHOLE: ocio.WHOLE_BOUND,
    "DNG" + WITH_CONFIG: 0.95,
}


def input_image(oiiotool):
    """Return the path of the 12-MP EXR, made from the interior render."""
    path = FOLDER / "input.exr"
    if not path.exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        source = ROOT / "tests" / "data" / "interior.exr"
        resize = ["--resize", f"{WIDTH}x{HEIGHT}", "-d", "half", "--compression", "zip"]
        subprocess.run([oiiotool, source, *resize, "-o", path], check=True)
    return path


def config_of(name):
    """Return the config that a command has, None if it has none."""
    if name.endswith(WITH_CONFIG):
        return ROOT / "ocio" / "sensors.ocio"
    return FOLDER / "bench.ocio" if name == ocio.WHOLE else None


def peer_command(name):
    """Return the command that a command is compared with, of the same config."""
    return PEER + WITH_CONFIG if name.endswith(WITH_CONFIG) else PEER


def measured(command, config=None):
    """Return (seconds, peak MB, CPU seconds) of one process."""
    environment = {name: v for name, v in os.environ.items() if name != "OCIO"}
    if config is not None:
        environment["OCIO"] = str(config)
    begin = time.perf_counter()
    process = subprocess.Popen(command, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"failed: {' '.join(map(str, command))}")
    cpu = usage.ru_utime + usage.ru_stime
    return time.perf_counter() - begin, usage.ru_maxrss / 1024, cpu


def version_of(oiiotool):
    """Return what an oiiotool says its version is."""
    done = subprocess.run([oiiotool, "--version"], capture_output=True, text=True)
    return done.stdout.strip()


def process_results(oiiotool, rounds):
    """Return {name: [(seconds, peak MB, CPU seconds, file MB)]} of its commands."""
    source = input_image(oiiotool)
    ocio.config_file(FOLDER)
    results = {name: [] for name in COMMANDS}
    for number in range(rounds + 1):
        for name, (arguments, ending) in COMMANDS.items():
            out = FOLDER / f"out.{ending}"
            command = [oiiotool, source, *arguments, "-o", out]
            result = measured(command, config_of(name))
            size = out.stat().st_size / 1e6 if out.exists() else 0.0
            if number:  # the first round warms the cache
                results[name].append((*result, size))
    return results


def bench_processes(oiiotool, rounds):
    """Print a table of one oiiotool's commands."""
    print(
        f"\noiiotool {version_of(oiiotool)}, {WIDTH}x{HEIGHT} half EXR, "
        f"median of {rounds} rounds"
    )
    print_table(process_results(oiiotool, rounds))


def print_table(results):
    """Print medians, their ratios against the peer, and the bounds."""
    medians = {
        name: [statistics.median(column) for column in zip(*rows, strict=True)]
        for name, rows in results.items()
    }
    print(
        f"{'':30}{'s':>7}{'ratio':>7}{'least':>7}{'bound':>7}"
        f"{'CPU s':>7}{'peak MB':>9}{'file MB':>9}"
    )
    for name, (seconds, peak, cpu, size) in medians.items():
        peer = peer_command(name)
        ratio = seconds / medians[peer][0]
        # What a quiet machine would show: the quickest rounds alone.
        least = min(results[name])[0] / min(results[peer])[0]
        bound = BOUNDS.get(name, "")
        print(
            f"{name:30}{seconds:7.3f}{ratio:7.2f}{least:7.2f}{bound:>7}"
            f"{cpu:7.3f}{peak:9.0f}"
            f"{size:9.1f}"
        )
