# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Speed of spectra in the core: convention spectral beside convention dng, and spectral
images beside NumPy's product of the same matrix. Every round runs all, so that whatever
else the machine does meets them alike; a ratio is that of medians."""

import statistics
import time

import numpy as np

SENSOR = "canon-600d"
LIGHT = "FL2"
BINS = np.arange(400.0, 701.0, 10.0)
WHITE = 1000.0  # cd/m2
CONVENTION_BOUND = 150  # MP/s of convention spectral on 2 threads
IMAGE_BOUND = 25  # MP/s of 31 bins on each thread


def medians(runs, rounds):
    """Return {name: seconds} of functions; each round runs each once."""
    seconds = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            begin = time.perf_counter()
            run()
            seconds[name].append(time.perf_counter() - begin)
    return {name: statistics.median(values) for name, values in seconds.items()}


def bench_conventions(size, rounds):
    """Print megapixels per second of simulate() in both conventions."""
    import cg2raw

    height, width = size
    sensor = cg2raw.Sensor(SENSOR)
    scene = np.random.default_rng(1).random((height, width, 3), dtype=np.float32)

    def run(convention, threads):
        return lambda: sensor.simulate(
            scene, illuminant=LIGHT, convention=convention, threads=threads
        )

    print(f"\nconventions, {SENSOR} under {LIGHT}, float32 -> uint16 mosaic")
    for threads in (1, 2):
        names = ("dng", "spectral")
        found = medians({name: run(name, threads) for name in names}, rounds)
        for name in names:
            rate = height * width / 1e6 / found[name]
            goal = f"(at least {CONVENTION_BOUND})" if threads == 2 else ""
            ratio = found[name] / found["dng"]
            print(
                f"{name:10} {threads} threads {rate:7.0f} MP/s, {ratio:4.2f} of dng's "
                f"time {goal if name == 'spectral' else ''}".rstrip()
            )


def bench_images(size, rounds):
    """Print megapixels per second of spectra that become camera RGB."""
    import cg2raw
    from cg2raw import _core

    height, width = size[0] // 4, size[1]
    sensor = cg2raw.Sensor(SENSOR)
    light = sensor.illuminant(LIGHT)
    response = _core.SpectralResponse(sensor.profile, light, BINS.tolist(), WHITE)
    shape = (height, width, len(BINS))
    spectra = np.random.default_rng(2).random(shape, dtype=np.float32)
    matrix = response.per_bin.astype(np.float32)
    print(f"\nspectral images, {len(BINS)} bins -> camera RGB, one thread each")
    found = medians(
        {
            "cg2raw": lambda: response.to_camera(spectra, threads=1),
            "numpy.matmul": lambda: spectra.reshape(-1, len(BINS)) @ matrix,
        },
        rounds,
    )
    rate = height * width / 1e6 / found["cg2raw"]
    print(
        f"{rate:.0f} MP/s (at least {IMAGE_BOUND}), "
        f"{found['cg2raw'] / found['numpy.matmul']:.2f} of numpy.matmul's time, "
        "which may use all threads"
    )


def bench(size, rounds):
    """Print all of it. size : (H, W) of the frames."""
    bench_conventions(size, rounds)
    bench_images(size, rounds)
