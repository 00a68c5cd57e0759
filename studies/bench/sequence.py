# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure `cg2raw convert` of a shot of 4K half-float EXRs.

The peer is the same command on one core. Each is run for a few frames and for many, and
their difference counts, so that starting Python does not. The rate of all cores is what
they allow only if nothing else runs; CPU seconds a frame hardly depend on that."""

import os
import statistics
import subprocess
import sys
import time

WIDTH, HEIGHT = 4096, 2160
SENSOR = ["--sensor", "samsung-s20fe", "--illuminant", "2856K", "--iso", "800"]
FRAMES = 8  # of each core, beyond the first
BOUNDS = {"rate": 0.9, "memory": 1.1}


def make_shot(source, folder, frames):
    """Write the frames of a shot: one EXR under many names."""
    folder.mkdir(parents=True, exist_ok=True)
    first = folder / "shot.0001.exr"
    if not first.exists():
        size = ["--resize", f"{WIDTH}x{HEIGHT}", "-d", "half", "--compression", "zip"]
        subprocess.run(["oiiotool", source, *size, "-o", first], check=True)
    for number in range(2, frames + 1):
        path = folder / f"shot.{number:04}.exr"
        if not path.exists():
            os.link(first, path)


def converted(folder, frames, cores):
    """Return (seconds, CPU seconds, peak MB) of converting frames on some cores."""
    command = [sys.executable, "-m", "cg2raw", "convert", f"{folder}/shot.####.exr"]
    command += ["-o", f"{folder}/raw/", "--frames", f"1-{frames}", *SENSOR]
    command += ["--framerate", "24", "--quiet"]
    begin = time.perf_counter()
    process = subprocess.Popen(
        command, preexec_fn=lambda: os.sched_setaffinity(0, cores)
    )
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"failed: {' '.join(map(str, command))}")
    cpu = usage.ru_utime + usage.ru_stime
    return time.perf_counter() - begin, cpu, usage.ru_maxrss / 1024


def bench(source, folder, rounds):
    """Print the frames per second of one core and of all, their ratio, and memory."""
    cores = os.sched_getaffinity(0)
    ways = {"one core": {min(cores)}, f"{len(cores)} cores": cores}
    make_shot(source, folder, len(cores) * (1 + FRAMES))
    rates = {name: [] for name in ways}
    costs = {name: [] for name in ways}
    peaks = {}
    for _ in range(rounds):
        for name, some in ways.items():
            few, many = len(some), len(some) * (1 + FRAMES)
            short, cpu_of_few, small = converted(folder, few, some)
            long, cpu_of_many, large = converted(folder, many, some)
            rates[name].append((many - few) / (long - short))
            costs[name].append((cpu_of_many - cpu_of_few) / (many - few))
            peaks[name] = small, large
    print(
        f"\n{WIDTH}x{HEIGHT} half EXRs, ISO 800, ljpeg, median of {rounds} rounds; "
        f"load of the last minute {os.getloadavg()[0]:.1f}"
    )
    for name, values in rates.items():
        small, large = peaks[name]
        print(
            f"{name:10}{statistics.median(values):6.2f} frames/s, "
            f"{statistics.median(costs[name]):.3f} CPU s a frame, peak {small:.0f} MB, "
            f"{large:.0f} MB of {1 + FRAMES} times as many"
        )
    one, every = map(statistics.median, rates.values())
    print(
        f"rate       {every / one / len(cores):6.2f} of what the cores allow "
        f"(at least {BOUNDS['rate']}); memory {large / small:.2f} (at most "
        f"{BOUNDS['memory']})"
    )
