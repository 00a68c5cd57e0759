# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure whole oiiotool processes on a 12-MP half-float EXR, and the core alone.

Every round runs each command once, the peer among them, so that whatever else the
machine does meets them all alike; a ratio is that of medians."""

import argparse
import os
import statistics
import subprocess
import time
from pathlib import Path

import numpy as np

import bench_dataset
import bench_diagnose
import bench_ocio
import bench_rows
import bench_sequence
import bench_spectral

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "out" / "bench"
WIDTH, HEIGHT = 4032, 3024
SENSOR = ["--attrib", "dng:sensor", "samsung-s20fe"]
LIGHT = ["--attrib", "dng:illuminant", "2856K"]
PLAIN = ["--attrib", "dng:compression", "none"]
PEER = "16-bit TIFF (peer)"
COMMANDS = {
    PEER: (["-d", "uint16", "--compression", "none"], "tif"),
    "DNG": ([*SENSOR, *LIGHT, *PLAIN], "dng"),
    "DNG, ISO 3200": ([*SENSOR, *LIGHT, *PLAIN, "--attrib", "dng:iso", "3200"], "dng"),
    "DNG, ljpeg": ([*SENSOR, *LIGHT], "dng"),
    bench_ocio.WHOLE: (["--tocolorspace", bench_ocio.SPACE, *PLAIN], "dng"),
    "DNG, ljpeg, ISO 3200": ([*SENSOR, *LIGHT, "--attrib", "dng:iso", "3200"], "dng"),
}
BOUNDS = {
    "DNG": 1.0,
    "DNG, ISO 3200": 1.3,
    "DNG, ljpeg": 1.5,
    bench_ocio.WHOLE: bench_ocio.WHOLE_BOUND,
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


def measured(command):
    """Return (seconds, peak MB, CPU seconds) of one process."""
    environment = {**os.environ, "OCIO": str(FOLDER / "bench.ocio")}
    begin = time.perf_counter()
    process = subprocess.Popen(command, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"failed: {' '.join(map(str, command))}")
    cpu = usage.ru_utime + usage.ru_stime
    return time.perf_counter() - begin, usage.ru_maxrss / 1024, cpu


def bench_processes(oiiotool, rounds):
    """Print a table of one oiiotool's commands."""
    version = subprocess.run([oiiotool, "--version"], capture_output=True, text=True)
    print(
        f"\noiiotool {version.stdout.strip()}, {WIDTH}x{HEIGHT} half EXR, "
        f"median of {rounds} rounds"
    )
    source = input_image(oiiotool)
    bench_ocio.config_file(FOLDER)
    results = {name: [] for name in COMMANDS}
    for number in range(rounds + 1):
        for name, (arguments, ending) in COMMANDS.items():
            out = FOLDER / f"out.{ending}"
            result = measured([oiiotool, source, *arguments, "-o", out])
            if number:  # the first round warms the cache
                results[name].append((*result, out.stat().st_size / 1e6))
    print_table(results)


def print_table(results):
    """Print medians, their ratios against the peer, and the bounds."""
    medians = {
        name: [statistics.median(column) for column in zip(*rows, strict=True)]
        for name, rows in results.items()
    }
    print(
        f"{'':24}{'s':>7}{'ratio':>7}{'least':>7}{'bound':>7}"
        f"{'CPU s':>7}{'peak MB':>9}{'file MB':>9}"
    )
    for name, (seconds, peak, cpu, size) in medians.items():
        ratio = seconds / medians[PEER][0]
        # What a quiet machine would show: the quickest rounds alone.
        least = min(results[name])[0] / min(results[PEER])[0]
        bound = BOUNDS.get(name, "")
        print(
            f"{name:24}{seconds:7.3f}{ratio:7.2f}{least:7.2f}{bound:>7}"
            f"{cpu:7.3f}{peak:9.0f}"
            f"{size:9.1f}"
        )


def bench_core(rounds):
    """Print megapixels per second of simulate() alone."""
    import cg2raw

    sensor = cg2raw.Sensor("samsung-s20fe")
    scene = np.random.default_rng(1).random((HEIGHT, WIDTH, 3), dtype=np.float32)
    print("\ncore alone, float32 in memory -> uint16 mosaic")
    for name, iso, bound in (("clean", None, 100), ("ISO 3200", 3200, 60)):
        for threads in (1, 2):
            seconds = []
            for _ in range(rounds):
                begin = time.perf_counter()
                sensor.simulate(scene, illuminant="2856K", iso=iso, threads=threads)
                seconds.append(time.perf_counter() - begin)
            rate = WIDTH * HEIGHT / 1e6 / statistics.median(seconds)
            goal = f"(at least {bound})" if threads == 2 else ""
            print(f"{name:10} {threads} threads {rate:7.0f} MP/s {goal}")


def main():
    """Run what was asked for."""
    parser = argparse.ArgumentParser(prog="bench", description=__doc__)
    parser.add_argument("--rounds", type=int, default=7, help="rounds (default 7)")
    parser.add_argument("--core", action="store_true", help="the core only")
    parser.add_argument("--ocio", action="store_true", help="OCIO in Python only")
    parser.add_argument("--dataset", action="store_true", help="cg2raw dataset only")
    parser.add_argument("--rows", type=int, help="a data set of so many rows only")
    parser.add_argument("--diagnose", action="store_true", help="diagnosis only")
    parser.add_argument("--spectral", action="store_true", help="spectra only")
    parser.add_argument("--sequence", action="store_true", help="a shot only")
    options = parser.parse_args()
    if options.diagnose:
        return bench_diagnose.bench(FOLDER / "diagnose")
    if options.spectral:
        return bench_spectral.bench((HEIGHT, WIDTH), options.rounds)
    if options.sequence:
        image = ROOT / "tests" / "data" / "interior.exr"
        return bench_sequence.bench(image, FOLDER / "sequence", options.rounds)
    if options.rows:
        image = ROOT / "tests" / "data" / "interior.exr"
        return bench_rows.bench(image, FOLDER / "dataset", options.rows)
    if options.dataset:
        image = input_image(ROOT / ".venv/bin/oiiotool")
        return bench_dataset.bench(image, FOLDER / "dataset", options.rounds)
    if not options.ocio:
        bench_core(options.rounds)
    if not options.core:
        FOLDER.mkdir(parents=True, exist_ok=True)
        bench_ocio.bench(FOLDER, options.rounds)
    if not options.core and not options.ocio:
        for oiiotool in (Path("/usr/bin/oiiotool"), ROOT / ".venv/bin/oiiotool"):
            bench_processes(oiiotool, options.rounds)


if __name__ == "__main__":
    main()
