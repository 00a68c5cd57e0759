# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Workers of a Dask cluster."""

from collections.abc import Generator, Iterable, Iterator
from types import ModuleType
from typing import Any

from cg2raw.dataset.job import give_up, make
from cg2raw.dataset.journal import Row
from cg2raw.dataset.target import Job

AHEAD = 2  # jobs per thread of the cluster that are submitted at a time
SECONDS = 30  # until a scheduler that does not answer is given up


def results(jobs: Iterable[Job], address: str) -> Generator[Row]:
    """Yield the result of each of @jobs as the cluster finishes it.

    A job whose worker dies is run elsewhere. Raises ValueError if there is no scheduler
    at @address, OSError with the message of a worker that cannot write."""
    distributed = imported()
    try:
        client = distributed.Client(address, timeout=SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ValueError(f"--scheduler {address}: cannot be reached: {error}") from None
    with client, client.as_current():
        yield from streamed(client, distributed, iter(jobs))


def imported() -> ModuleType:
    """Return the module distributed. Raises ValueError if it is not installed."""
    try:
        import distributed
    except ImportError:
        raise ValueError(
            "--scheduler: needs Dask; pip install 'cg2raw[cluster]'"
        ) from None
    return distributed


def streamed(
    client: Any, distributed: ModuleType, jobs: Iterator[Job]
) -> Iterator[Row]:
    """Yield results; never more than a few jobs per thread are on their way."""
    threads = sum(client.nthreads().values())
    room = AHEAD * max(threads, 1)
    flying: dict[str, Job] = {}
    stream = distributed.as_completed()
    for job in jobs:
        submit(client, stream, flying, job)
        if len(flying) >= room:
            yield finished(next(stream), flying)
    while flying:
        yield finished(next(stream), flying)


def submit(client: Any, stream: Any, flying: dict[str, Job], job: Job) -> None:
    """Send a job to the cluster."""
    future = client.submit(make, job, pure=False, retries=0)
    flying[future.key] = job
    stream.add(future)


def finished(future: Any, flying: dict[str, Job]) -> Row:
    """Return the result of a future that is done."""
    job = flying.pop(future.key)
    error = future.exception()
    if error is None:
        result: Row = future.result()
        return result
    if type(error).__name__ == "KilledWorker":
        return give_up(job, "the workers that had it died")
    raise OSError(" ".join(f"{error}".split()))
