# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Threads, forks, pools and long lives: the same bytes, and nothing leaks."""

import hashlib
import multiprocessing
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import cg2raw

RUN = {"illuminant": "3200K", "iso": 800, "seed": 5}
IMAGE = np.random.default_rng(3).uniform(0, 1.1, (200, 150, 3)).astype(np.float32)


def digest(path_and_threads):
    """Write a DNG; return its hash. What pools run."""
    path, threads = path_and_threads
    sensor = cg2raw.Sensor("sony-a7s-ii")
    frame = sensor.simulate(IMAGE, threads=threads, **RUN)
    cg2raw.write_dng(path, frame, threads=threads)
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    return digest((tmp_path_factory.mktemp("one") / "a.dng", 1))


@pytest.mark.parametrize("threads", [2, 3, 4, 7, 8, 16, 33, 64])
def test_the_bytes_do_not_depend_on_threads(threads, expected, tmp_path):
    assert digest((tmp_path / "a.dng", threads)) == expected


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_pools_of_processes(method, expected, tmp_path):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {method}")
    work = [(tmp_path / f"{i}.dng", i % 3) for i in range(6)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert set(pool.map(digest, work)) == {expected}


def test_a_pool_of_threads(expected, tmp_path):
    work = [(tmp_path / f"{i}.dng", 2) for i in range(12)]
    with ThreadPoolExecutor(4) as pool:
        assert set(pool.map(digest, work)) == {expected}


def test_a_fork_while_other_threads_simulate(expected, tmp_path):
    """No lock of the core is held for ever in the child."""
    sensor = cg2raw.Sensor("sony-a7s-ii")
    with ThreadPoolExecutor(2) as pool:
        work = [pool.submit(sensor.simulate, IMAGE, **RUN) for _ in range(8)]
        child = os.fork()
        if not child:
            os._exit(digest((tmp_path / "a.dng", 2)) != expected)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        assert len([frame.result() for frame in work]) == 8


# VmRSS, not ru_maxrss: what is held now
LIFE = """
import gc, os, re, sys
import numpy as np
import cg2raw

def held():
    gc.collect()
    status = open("/proc/self/status").read()
    return (int(re.search(r"VmRSS:\\s+(\\d+) kB", status)[1]),
            len(os.listdir("/proc/self/fd")), len(os.listdir("/proc/self/task")))

path, count = sys.argv[1], int(sys.argv[2])
image = np.random.default_rng(3).uniform(0, 1.1, (48, 64, 3)).astype(np.float32)
names = ["sony-a7s-ii", "fujifilm-x-m1", "canon-5d-mark-iv"]
sensors = [cg2raw.Sensor(name) for name in names]
for number in range(count + count // 4):
    sensor = sensors[number % 3]
    frame = sensor.simulate(image, illuminant=f"sample:{number}", seed=number)
    cg2raw.write_dng(path, frame)
    if number == count // 4:
        before = held()
after = held()
print(after[0] - before[0], after[1] - before[1], after[2] - before[2])
"""


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks Linux's /proc")
@pytest.mark.parametrize("count", [250, pytest.param(10000, marks=pytest.mark.slow)])
def test_exports_of_one_process_leak_nothing(count, tmp_path):
    command = [sys.executable, "-c", LIFE, tmp_path / "a.dng", str(count)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    memory, descriptors, threads = map(int, done.stdout.split())
    assert (descriptors, threads) == (0, 0)
    # 100 bytes an export at 10,000 would show, a page or two of the allocator's do not.
    assert memory < 1024, f"{memory} kB more after {count} exports"
    assert os.listdir(tmp_path) == ["a.dng"]
