# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure speed and memory: whole oiiotool processes and the core alone, or what is
asked for."""

import argparse
import statistics
import time
from pathlib import Path

import numpy as np

from studies.bench import dataset, diagnose, ocio, rows, sequence, spectral, table
from studies.bench.processes import (
    FOLDER,
    HEIGHT,
    OIIOTOOLS,
    WIDTH,
    bench_processes,
    input_image,
)
from studies.places import ROOT


def bench_core(rounds):
    """Print megapixels per second of simulate() alone."""
    import cg2raw

    sensor = cg2raw.Sensor("samsung-s20fe")
    scene = np.random.default_rng(1).random((HEIGHT, WIDTH, 3), dtype=np.float32)
    print("\ncore alone, float32 in memory -> uint16 mosaic")
    for name, iso, bound in (("clean", None, 100), ("ISO 3200", 3200, 350)):
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
    parser.add_argument("--all", action="store_true", help="one table, with peers")
    parser.add_argument("--json", type=Path, metavar="FILE", help="of --all")
    options = parser.parse_args()
    if options.json and not options.all:
        parser.error("--json is the table of --all as JSON: add --all")
    if options.all:
        return table.bench(options.rounds, options.json)
    if options.diagnose:
        return diagnose.bench(FOLDER / "diagnose")
    if options.spectral:
        return spectral.bench((HEIGHT, WIDTH), options.rounds)
    if options.sequence:
        image = ROOT / "tests" / "data" / "interior.exr"
        return sequence.bench(image, FOLDER / "sequence", options.rounds)
    if options.rows:
        image = ROOT / "tests" / "data" / "interior.exr"
        return rows.bench(image, FOLDER / "dataset", options.rows)
    if options.dataset:
        image = input_image(ROOT / ".venv/bin/oiiotool")
        return dataset.bench(image, FOLDER / "dataset", options.rounds)
    if not options.ocio:
        bench_core(options.rounds)
    if not options.core:
        FOLDER.mkdir(parents=True, exist_ok=True)
        ocio.bench(FOLDER, options.rounds)
    if not options.core and not options.ocio:
        for oiiotool in OIIOTOOLS:
            bench_processes(oiiotool, options.rounds)


if __name__ == "__main__":
    main()
