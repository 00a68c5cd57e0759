# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A Dask cluster makes the same bytes, also when one of its workers is killed."""

import contextlib
import re
import socket
import subprocess
import sys
import time

import pytest

from dataset.data_sets import (
    OPTIONS,
    check_agreement,
    contents,
    files_in,
    scene,
    start,
    write_image,
)
from python.commands import fails, run

pytestmark = pytest.mark.slow
pytest.importorskip("distributed", reason="Dask's distributed is not installed")


def free_port():
    """Return a port that nobody listens at."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def dask(program, *arguments):
    """Start dask-scheduler or dask-worker."""
    words = [sys.executable, "-m", f"distributed.cli.dask_{program}", *arguments]
    return subprocess.Popen(
        list(map(str, words)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def worker(address):
    """Start a worker of one thread, without the nanny that would start it again."""
    return dask("worker", address, "--nthreads", 1, "--no-nanny", "--no-dashboard")


@pytest.fixture
def cluster():
    """Return (address, [worker process, worker process]) of a cluster of its own."""
    import distributed

    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    with contextlib.ExitStack() as stack:
        processes = [
            dask("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard")
        ]
        stack.callback(stop, processes)
        processes += [worker(address), worker(address)]
        with distributed.Client(address, timeout=60) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, processes[1:]


def stop(processes):
    """End processes that this test started."""
    for process in processes:
        process.kill()
        process.wait()


def test_cluster_makes_the_same_bytes(images, tmp_path, cluster):
    address, _ = cluster
    (images / "bad.exr").write_text("no image")
    try:
        done = run(
            "dataset", images, tmp_path / "dask", *OPTIONS, "--scheduler", address
        )
        assert done.code == 1 and "bad.exr" in done.err
        run("dataset", images, tmp_path / "local", *OPTIONS)
    finally:
        (images / "bad.exr").unlink()
    assert contents(tmp_path / "dask") == contents(tmp_path / "local")
    check_agreement(tmp_path / "dask")


def test_a_killed_worker_loses_nothing(tmp_path, cluster):
    address, workers = cluster
    for number in range(24):
        write_image(tmp_path / f"in/{number}.exr", scene((400, 600), number))
    options = [*OPTIONS, "--illuminants", "6"]
    out = tmp_path / "out"
    process = start(tmp_path / "in", out, *options, "--scheduler", address)
    end = time.monotonic() + 120
    while len(files_in(out)) < 20 and time.monotonic() < end:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    workers[0].kill()
    assert len(files_in(out)) < 24 * 24  # it was killed in the midst of it
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    check_agreement(out)
    run("dataset", tmp_path / "in", tmp_path / "local", *options)
    assert contents(out) == contents(tmp_path / "local")


def test_no_scheduler_is_one_line(images, tmp_path, monkeypatch):
    monkeypatch.setattr("cg2raw.dataset.cluster.SECONDS", 1)
    address = f"tcp://127.0.0.1:{free_port()}"
    message = fails(
        "dataset", images, tmp_path / "out", *OPTIONS, "--scheduler", address
    )
    assert re.search(rf"--scheduler {address}: cannot be reached", message)
