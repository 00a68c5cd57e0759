# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A server as that of injector.h, for cg2raw: it forks when all modules are loaded.

forked.py TARGET FOLDER, under the injector: a line of standard input is what is to
fail, and two lines of output are the process and how it ended. What it prints goes to
standard error. Python's imports are so not what is tested, nor are they waited for.
"""

import importlib
import os
import sys
import traceback
import types

from faults.injector import begin, environment_of
from faults.targets import TARGETS

FAILED = 70  # an exit code that no command has


class ForkedWorker:
    """Takes the place of subprocess.Popen: a worker of a data set, by fork alone."""

    def __init__(self, words, stdin, stdout, stderr, env, **_):
        requests, self.stdin = pipe("w")
        answers_end, answers = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            for source, number in ((requests, 0), (answers, 1), (stderr.fileno(), 2)):
                os.dup2(source, number)
            os.close(self.stdin.fileno())
            os.close(answers_end)
            sys.argv = words[-2:]
            begin(os.environ["FAULT_WORDS"])  # counts anew, as a new process does
            os._exit(ended(run_worker))
        os.close(requests)
        os.close(answers)
        self.stdout = os.fdopen(answers_end, "rb")
        self.returncode = None

    def kill(self):
        """End it, as Popen does."""
        if self.returncode is None:
            os.kill(self.pid, 9)

    def wait(self):
        """Wait for its end, as Popen does."""
        if self.returncode is None:
            _, status = os.waitpid(self.pid, 0)
            self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode


def pipe(mode):
    """Return (descriptor of the child, stream of ours)."""
    end, ours = os.pipe()
    return end, os.fdopen(ours, f"{mode}b")


def run_worker():
    """Run the worker of a data set on the pipes that it got."""
    from cg2raw.dataset import worker

    sys.stdin = os.fdopen(0)
    worker.main()
    return 0


def ended(run):
    """Return the exit code of run(), as the interpreter has it."""
    try:
        code = run()
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else 1
    except BaseException:
        traceback.print_exc()
        code = FAILED
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    return code or 0


def child(target, folder, words):
    """Run the target in this process, which has just been forked, and end it."""
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    sys.stdout = os.fdopen(os.dup(1), "w")
    os.environ.update(environment_of(words))
    os.environ["FAULT_WORDS"] = words
    if target.name == "dataset":
        from cg2raw.dataset import local

        local.subprocess = types.SimpleNamespace(Popen=ForkedWorker, PIPE=-1)
    begin(words)
    os._exit(ended(lambda: target.run(folder)))


def load_what_a_run_loads(target, folder):
    """Import all modules that one run imports; it runs in a fork, which ends."""
    end, names = os.pipe()
    if os.fork() == 0:
        os.dup2(2, 1)
        ended(lambda: target.run(folder))
        with os.fdopen(names, "w") as stream:
            stream.write("\n".join(sys.modules))
        os._exit(0)
    os.close(names)
    with os.fdopen(end) as stream:
        for name in stream.read().splitlines():
            if name.partition(".")[0] != "__main__":
                try:
                    importlib.import_module(name)
                except Exception:  # made at run time
                    continue
    os.wait()


def main(name, folder):
    """Serve until the input ends."""
    target = TARGETS[name]
    target.load(folder)
    load_what_a_run_loads(target, folder)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    print("ready", file=answers)
    for line in sys.stdin:
        process = os.fork()
        if process == 0:
            child(target, folder, line.strip())
        print(process, file=answers)
        _, status = os.waitpid(process, 0)
        print(status, file=answers)


if __name__ == "__main__":
    main(*sys.argv[1:])
