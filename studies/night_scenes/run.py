# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders the frames that a folder lacks, by several worker processes."""

import contextlib
import json
import queue
import signal
import subprocess
import sys
import threading
import time

from .choices.scenes import scene
from .folder import Refused, name

WORKER = (sys.executable, "-m", f"{__package__}.worker")


class Worker:
    """One process, fed and read by a thread of its own."""

    def __init__(self, command, log):
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
            start_new_session=True,  # Ctrl-C reaches the run, which ends its workers
        )

    def ask(self, request):
        """Return the answer to one request; a worker that ends is an answer too."""
        closed = (OSError, ValueError)  # its pipe, or ours
        with contextlib.suppress(*closed):  # one that has ended may have said why
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
        try:
            line = self.process.stdout.readline()
        except closed:
            line = ""
        if not line:
            code = self.process.wait()
            return {"index": request["index"], "error": f"the worker ended with {code}"}
        try:
            return json.loads(line)
        except ValueError:
            return {"index": request["index"], "error": f"the worker said {line!r}"}

    def stop(self):
        """End the process at once; what it wrote has no frame's name yet."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()


def serve(worker, wanted, folder, threads, answers):
    """Have one worker render from the queue @wanted until it is empty."""
    settings = folder.settings
    while True:
        try:
            index = wanted.get_nowait()
        except queue.Empty:
            return
        answer = worker.ask(
            {
                "index": index,
                "path": str(folder.part(index)),
                "width": settings.width,
                "samples": settings.samples,
                "threads": threads,
            }
        )
        answers.put(answer)
        if answer["error"]:
            return


def render(folder, indices, workers, threads, say, command=WORKER, log=None):
    """Render those of @indices that @folder, entered, lacks; return how many were.

    say : called with one line per frame. log : where workers' own words go; None: they
    are dropped. Raises Refused, KeyboardInterrupt; no process is left then."""
    missing = [index for index in indices if not folder.is_done(index)]
    if len(missing) < len(indices):
        say(f"{len(indices) - len(missing)} of {len(indices)} frames are there")
    wanted, answers = queue.Queue(), queue.Queue()
    for index in missing:
        wanted.put(index)
    count = min(workers, len(missing))
    started = [Worker(command, log or subprocess.DEVNULL) for _ in range(count)]
    try:
        for worker in started:
            given = (worker, wanted, folder, threads, answers)
            threading.Thread(target=serve, args=given, daemon=True).start()
        start = time.monotonic()
        for done in range(1, len(missing) + 1):
            answer = answers.get()
            shown = take(folder, answer)
            left = (time.monotonic() - start) / done * (len(missing) - done)
            seconds = f"{answer['seconds']:.0f} s  {duration(left)} left"
            say(f"[{done:3d}/{len(missing)}] {shown}  {seconds}")
    finally:
        for worker in started:
            worker.stop()
    return len(missing)


def take(folder, answer):
    """Accept the frame of an answer and say what it is. Raises Refused if it failed."""
    index = answer["index"]
    if answer["error"]:
        where = folder.path if index is None else folder.frame(index)
        raise Refused(f"{where}: {answer['error']}: {folder.room()}")
    described = scene(index)
    folder.accept(index, described.as_json())
    return f"{name(index)}.exr  {described.kind}, {described.layout}"


def duration(seconds):
    """Return a time in words."""
    minutes = round(seconds / 60)
    if minutes < 1:
        return f"{seconds:.0f} s"
    return (
        f"{minutes // 60} h {minutes % 60:02d} min"
        if minutes >= 60
        else f"{minutes} min"
    )


@contextlib.contextmanager
def terminable():
    """Let SIGTERM end a run as Ctrl-C does."""

    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
