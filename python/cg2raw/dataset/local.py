# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Workers of this machine: processes that make one image at a time."""

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
from collections.abc import Generator, Iterable, Iterator
from dataclasses import asdict
from itertools import islice
from typing import BinaryIO

from cg2raw.dataset.job import Job, give_up
from cg2raw.dataset.journal import Row
from cg2raw.io.atomic_file import create

TRIES = 2  # of an image whose worker dies
LONGEST = 1 << 16  # bytes that are read at a time
COMMAND = "from cg2raw.dataset.worker import main; main()"


class Worker:
    """A process, its pipes, and the job that it has."""

    def __init__(self, log: BinaryIO) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self.process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
            env={**os.environ, "PYTHONPATH": path},
            start_new_session=True,  # Ctrl-C is ours to answer
        )
        # Pipes, so they are there.
        assert self.process.stdin is not None and self.process.stdout is not None
        self.requests, self.answers = self.process.stdin, self.process.stdout
        self.job: Job
        self.tries = 0
        self.rest = b""  # of a line that is not complete yet

    def give(self, job: Job, tries: int) -> None:
        """Hand over a job."""
        self.job, self.tries = job, tries
        try:
            self.requests.write(json.dumps(asdict(job)).encode() + b"\n")
            self.requests.flush()
        except BrokenPipeError:
            pass  # it died; its end of the other pipe tells

    def read(self) -> list[Row] | None:
        """Return what the process has said since, None if it has ended.

        To be called when there is something to read: it waits otherwise."""
        data = os.read(self.answers.fileno(), LONGEST)
        if not data:
            return None
        *lines, self.rest = (self.rest + data).split(b"\n")
        return [json.loads(line) for line in lines]

    def stop(self) -> None:
        """End the process at once, which is safe at any time."""
        self.process.kill()
        self.process.wait()
        self.answers.close()
        with contextlib.suppress(BrokenPipeError):
            self.requests.close()


def results(jobs: Iterable[Job], count: int, log: str) -> Generator[Row]:
    """Yield the result of each of @jobs, in the order in which they are finished, and
    before it {"image", "files"} whenever some of its files are.

    count : workers. log : the path of a file for what they print. A worker that dies is
    replaced and its image tried again, then given up. Raises OSError with the message
    of a worker that cannot write."""
    with create(log) as stream, selectors.DefaultSelector() as selector:
        pool = Pool(iter(jobs), selector, stream)
        try:
            for job in islice(pool.jobs, count):
                pool.hire().give(job, 1)
            while pool.workers:
                for key, _ in selector.select():
                    yield from pool.serve(key.data)
        finally:
            for worker in pool.workers:
                worker.stop()


class Pool:
    """The workers that are busy, and the jobs that are left."""

    def __init__(
        self, jobs: Iterator[Job], selector: selectors.BaseSelector, log: BinaryIO
    ) -> None:
        self.jobs, self.selector, self.log = jobs, selector, log
        self.workers: set[Worker] = set()

    def hire(self) -> Worker:
        """Start a Worker."""
        worker = Worker(self.log)
        self.workers.add(worker)
        self.selector.register(worker.answers, selectors.EVENT_READ, worker)
        return worker

    def dismiss(self, worker: Worker) -> int:
        """End a Worker; return the exit code of one that had ended by itself."""
        self.selector.unregister(worker.answers)
        self.workers.discard(worker)
        worker.stop()
        return worker.process.returncode

    def serve(self, worker: Worker) -> Iterator[Row]:
        """Yield what a worker says; give it the next job when one is done."""
        said = worker.read()
        if said is None:
            yield from self.replace(worker)
            return
        for row in said:
            if "failure" in row:
                raise OSError(row["failure"])
            if "reason" in row:
                self.occupy(worker)
            yield row

    def replace(self, worker: Worker) -> Iterator[Row]:
        """Try the job of a worker that has died again, or yield that it is given up."""
        job, tries = worker.job, worker.tries
        worker.process.wait()
        code = self.dismiss(worker)
        worker = self.hire()
        if tries < TRIES:
            worker.give(job, tries + 1)
            return
        row = give_up(job, self.ended(code))
        self.occupy(worker)
        yield row

    def occupy(self, worker: Worker) -> None:
        """Give a worker the next job, or let it go."""
        following = next(self.jobs, None)
        if following is None:
            self.dismiss(worker)
        else:
            worker.give(following, 1)

    def ended(self, code: int) -> str:
        """Return the reason for which an image is given up."""
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return f"the process that worked on it ended twice ({how}); see {self.log.name}"
