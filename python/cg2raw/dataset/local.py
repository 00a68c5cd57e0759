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
from dataclasses import asdict

from cg2raw.dataset.job import give_up

TRIES = 2  # of an image whose worker dies
COMMAND = "from cg2raw.dataset.worker import main; main()"


class Worker:
    """A process, its pipes, and the job that it has."""

    def __init__(self):
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self.process = subprocess.Popen(
            [sys.executable, "-c", COMMAND, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": path},
            start_new_session=True,  # Ctrl-C is ours to answer
        )
        self.job, self.tries = None, 0

    def give(self, job, tries):
        """Hand over a job."""
        self.job, self.tries = job, tries
        try:
            self.process.stdin.write(json.dumps(asdict(job)).encode() + b"\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # it died; its end of the other pipe tells

    def answer(self):
        """Return the answer to the job, None if the process died over it."""
        line = self.process.stdout.readline()
        return json.loads(line) if line.endswith(b"\n") else None

    def stop(self):
        """End the process at once, which is safe at any time."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()


def results(jobs, count):
    """Yield the result of each of @jobs, in the order in which they are finished.

    count : workers. A worker that dies is replaced and its image tried again, then
    given up. Raises OSError with the message of a worker that cannot write."""
    jobs = iter(jobs)
    workers = set()
    with selectors.DefaultSelector() as selector:
        try:
            for job in first(jobs, count):
                hire(workers, selector).give(job, 1)
            while workers:
                for key, _ in selector.select():
                    yield from served(key.data, jobs, workers, selector)
        finally:
            for worker in workers:
                worker.stop()


def first(items, count):
    """Yield the first @count of an iterator, or fewer."""
    for _, item in zip(range(count), items, strict=False):
        yield item


def hire(workers, selector):
    """Start a Worker."""
    worker = Worker()
    workers.add(worker)
    selector.register(worker.process.stdout, selectors.EVENT_READ, worker)
    return worker


def served(worker, jobs, workers, selector):
    """Take a worker's answer, give it the next job; yield the result."""
    answer = worker.answer()
    job, tries = worker.job, worker.tries
    if answer is None:
        worker.process.wait()
        selector.unregister(worker.process.stdout)
        workers.discard(worker)
        reason = died(worker.process.returncode)
        worker.stop()
        worker = hire(workers, selector)
        if tries < TRIES:
            worker.give(job, tries + 1)
            return
        answer = give_up(job, reason)
    if "failure" in answer:
        raise OSError(answer["failure"])
    job = next(jobs, None)
    if job is None:
        selector.unregister(worker.process.stdout)
        workers.discard(worker)
        worker.stop()
    else:
        worker.give(job, 1)
    yield answer


def died(code):
    """Return how a process ended."""
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    return f"the process that worked on it ended twice ({how})"
