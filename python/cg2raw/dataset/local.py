# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Workers of this machine: processes that make one image at a time."""

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Generator, Iterable, Iterator
from dataclasses import asdict
from itertools import islice
from typing import BinaryIO, TypeAlias

from cg2raw.dataset.job import give_up
from cg2raw.dataset.journal import Row
from cg2raw.dataset.target import Job
from cg2raw.interrupts import tidied
from cg2raw.io.atomic_file import create
from cg2raw.system import end_process, new_session

TRIES = 2  # of an image whose worker dies
LONGEST = 1 << 16  # bytes that are read at a time
# What workers have said: None when one has ended.
Heard: TypeAlias = "queue.SimpleQueue[tuple[Worker, list[Row] | None]]"
COMMAND = "from cg2raw.dataset.worker import main; main()"


class Worker:
    """A process, its pipes, and the job that it has."""

    def __init__(self, log: BinaryIO, heard: Heard) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self.process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
            env={**os.environ, "PYTHONPATH": path},
            start_new_session=True,  # Ctrl-C is ours to answer
            creationflags=new_session(),
        )
        # Pipes, so they are there.
        assert self.process.stdin is not None and self.process.stdout is not None
        self.requests, self.answers = self.process.stdin, self.process.stdout
        self.job: Job
        self.tries = 0
        self.rest = b""  # of a line that is not complete yet
        # A thread, because Windows cannot wait for several pipes at once.
        self.listener = threading.Thread(target=self.listen, args=(heard,), daemon=True)
        self.listener.start()

    def give(self, job: Job, tries: int) -> None:
        """Hand over a job."""
        self.job, self.tries = job, tries
        try:
            self.requests.write(json.dumps(asdict(job)).encode() + b"\n")
            self.requests.flush()
        except BrokenPipeError:
            pass  # it died; its end of the other pipe tells

    def listen(self, heard: Heard) -> None:
        """Put all that the process says into @heard, None when it has ended."""
        said: list[Row] | None = []
        while said is not None:
            said = self.read()
            heard.put((self, said))

    def read(self) -> list[Row] | None:
        """Wait for the process to say something; return it, None if it has ended."""
        data = os.read(self.answers.fileno(), LONGEST)
        if not data:
            return None
        *lines, self.rest = (self.rest + data).split(b"\n")
        return [json.loads(line) for line in lines]

    def stop(self) -> None:
        """End the process at once, which is safe at any time."""
        self.process.kill()
        self.process.wait()
        self.listener.join()
        self.answers.close()
        with contextlib.suppress(BrokenPipeError):
            self.requests.close()


def results(jobs: Iterable[Job], count: int, log: str) -> Generator[Row]:
    """Yield the result of each of @jobs, in the order in which they are finished, and
    before it {"image", "files"} whenever some of its files are.

    count : workers. log : the path of a file for what they print. A worker that dies is
    replaced and its image tried again, then given up. Raises OSError with the message
    of a worker that cannot write."""
    with create(log) as stream:
        pool = Pool(iter(jobs), stream, log)
        try:
            with tidied(pool.kill):
                for job in islice(pool.jobs, count):
                    pool.hire().give(job, 1)
                while pool.workers:
                    yield from pool.serve(*pool.heard.get())
        finally:
            for worker in pool.workers:
                worker.stop()


class Pool:
    """The workers that are busy, and the jobs that are left."""

    def __init__(self, jobs: Iterator[Job], log: BinaryIO, path: str) -> None:
        self.jobs, self.log, self.path = jobs, log, path
        self.heard: Heard = queue.SimpleQueue()
        self.workers: set[Worker] = set()

    def hire(self) -> Worker:
        """Start a Worker."""
        worker = Worker(self.log, self.heard)
        self.workers.add(worker)
        return worker

    def kill(self) -> None:
        """End all processes when a signal ends this one, which may hold locks of
        theirs."""
        for worker in self.workers:
            with contextlib.suppress(OSError):
                end_process(worker.process.pid)

    def dismiss(self, worker: Worker) -> int:
        """End a Worker; return the exit code of one that had ended by itself."""
        self.workers.discard(worker)
        worker.stop()
        return worker.process.returncode

    def serve(self, worker: Worker, said: list[Row] | None) -> Iterator[Row]:
        """Yield what a worker says; give it the next job when one is done."""
        if worker not in self.workers:
            return  # dismissed; its end is no news
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
        return f"the process that worked on it ended twice ({how}); see {self.path}"
