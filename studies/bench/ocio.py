# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure OCIO: the chain of a RAW space, the load of a config, oiiotool with both."""

import os
import time

import numpy as np
import PyOpenColorIO as ocio

from cg2raw import _core
from cg2raw_ocio import chain
from cg2raw_ocio.config import config_text, make_config
from cg2raw_ocio.spaces import group

SENSOR, LIGHT = "samsung-s20fe", "2856K"
SPACE = f"RAW - {SENSOR} - {LIGHT}"
SIDE = 1000  # pixels: one megapixel
RATE = 25.0  # MP/s of one thread, at least
SPACES, LOAD = 200, 0.3  # spaces, and seconds at most
WHOLE = "OCIO, DNG"  # against a 16-bit TIFF without a conversion
WHOLE_BOUND = 1.5


def config_file(folder):
    """Return the path of a config with the space that is measured."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "bench.ocio"
    path.write_text(config_text(make_config([_core.load_profile(SENSOR)], [LIGHT])))
    return path


def cpu_seconds(action, rounds):
    """Return the least CPU time of this thread: others on the machine do not count."""
    seconds = []
    for _ in range(rounds):
        begin = time.thread_time()
        action()
        seconds.append(time.thread_time() - begin)
    return min(seconds)


def megapixels_per_second(transforms, rounds):
    """Return the rate of a chain on packed float32 RGB, one thread."""
    processor = ocio.Config.CreateRaw().getProcessor(group(transforms))
    cpu = processor.getDefaultCPUProcessor()
    rgb = np.random.default_rng(1).random((SIDE, SIDE, 3), dtype=np.float32)
    image = ocio.PackedImageDesc(rgb, SIDE, SIDE, 3)
    return SIDE * SIDE / 1e6 / cpu_seconds(lambda: cpu.apply(image), rounds)


def bench_chain(rounds):
    """Print the rates of chains, beside that of a single matrix."""
    profile = _core.load_profile(SENSOR)
    matrix = megapixels_per_second([chain.matrix(np.eye(3) + 0.1)], rounds)
    print(
        f"\nOpenColorIO {ocio.__version__}, one thread (CPU time), packed float32 RGB"
    )
    print(f"{'one matrix (peer)':24}{matrix:7.0f} MP/s")
    for convention in ("dng", "paper"):
        for gain in (1.0, 0.8):
            transform = _core.camera_from_scene(
                profile, profile.illuminant(LIGHT), convention, gain, True
            )
            rate = megapixels_per_second(chain.camera_from_scene(transform), rounds)
            name = f"RAW, {convention}, gain {gain:g}"
            print(f"{name:24}{rate:7.1f} MP/s (at least {RATE:g})")


def bench_load(folder, rounds):
    """Print how long a config of many spaces takes to load."""
    profile = _core.load_profile(SENSOR)
    lights = [f"{2000 + 50 * i}K" for i in range(SPACES // 2)]
    config = make_config([profile], lights)
    for name, text in (("", config_text(config)), ("serialize()", config.serialize())):
        path = folder / "load.ocio"
        path.write_text(text)
        seconds = cpu_seconds(lambda: ocio.Config.CreateFromFile(str(path)), rounds)  # noqa: B023
        what = f"{SPACES} spaces {name}".strip()
        print(f"{what:24}{seconds:7.3f} s (at most {LOAD:g})")


def bench(folder, rounds):
    """Print all that needs no oiiotool."""
    load = os.getloadavg()[0]
    print(f"\nload of the machine {load:.1f} on {os.cpu_count()} processors")
    bench_chain(rounds)
    bench_load(folder, rounds)
