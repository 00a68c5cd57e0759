# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every fault at every place: run a target again and again, another call failing.

The n-th call fails, once, then with all that follow it, for n from 1 on until no call
is met. scripts/faults runs this."""

import argparse
import errno
import os
import re
import select
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path

from conftest import ROOT
from faults.injector import CALLS, Injector, compiled, words_of
from faults.judge import Ended, Known, contents, faults_of
from faults.targets import TARGETS, empty

LONGEST = 240  # s, that a run may take on a busy machine
NONE = words_of("none")


@dataclass
class Count:
    """Of a walk: runs, those that met the fault, and what was wrong."""

    tries: int = 0
    fired: int = 0
    findings: list[str] = field(default_factory=list)


class Server:
    """A process that forks a run of a target for each fault.

    What runs print is in a file, which is emptied before each."""

    def __init__(self, target, injector, folder, scratch):
        self.injector, self.folder = injector, folder
        self.path = scratch / "said.txt"
        self.said = self.path.open("ab")
        self.process = subprocess.Popen(
            command_of(target, folder),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.said,
            bufsize=0,
            env=environment_of(target, injector, scratch),
        )
        if not target.is_program:
            assert self.answer() == "ready"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.said.close()

    def answer(self, seconds=None):
        """Return a line that the server says, None if it says none in time."""
        line = b""
        while not line.endswith(b"\n"):
            if not select.select([self.process.stdout], [], [], seconds)[0]:
                return None
            letter = self.process.stdout.read(1)
            if not letter:
                raise RuntimeError(self.path.read_text()[-2000:])
            line += letter
        return line.decode().strip()

    def run(self, words, longest=LONGEST):
        """Return how a run ended; after @longest seconds it is killed."""
        self.injector.forget()
        self.said.truncate(0)
        self.process.stdin.write(f"{words}\n".encode())
        process = int(self.answer())
        status = self.answer(longest)
        if status is None:
            os.kill(process, 9)
            self.answer()
        text = self.path.read_bytes().decode(errors="backslashreplace")
        return Ended(None if status is None else int(status), text)


def command_of(target, folder):
    """Return the command line of a target's server."""
    if target.is_program:
        return [str(word) for word in target.words(folder)]
    return [sys.executable, ROOT / "tests/faults/forked.py", target.name, folder]


def environment_of(target, injector, scratch):
    """Return the variables of a target's server."""
    paths = [ROOT / "tests", ROOT / "tests/plugin", *filter(None, sys.path)]
    plugins = str(target.plugins) if target.is_program else "/nowhere"
    return {
        **{name: value for name, value in os.environ.items() if name != "OCIO"},
        **injector.environment("none"),
        "FAULT_SERVER": str(int(target.is_program)),
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "CG2RAW_PROFILE_PATH": str(ROOT / "plugins/profiles"),
        "OIIO_LIBRARY_PATH": plugins,
        "OPENIMAGEIO_PLUGIN_PATH": plugins,
        "OPENBLAS_NUM_THREADS": "1",  # threads do not outlast a fork
        "MPLBACKEND": "agg",
        "TMPDIR": str(scratch / "tmp"),
    }


class Walk:
    """Faults of one target, in a folder of its own below @scratch."""

    def __init__(self, target, library, scratch):
        self.target, self.scratch = target, scratch
        self.folder = scratch / "under"
        for name in ("under/in", "under/out", "tmp"):
            (scratch / name).mkdir(parents=True)
        target.prepare(self.folder)
        self.injector = Injector(library, self.folder, scratch)
        self.first = 1  # of the calls that are tried
        self.errors = None  # how many errors of each kind of call; None: all
        self.count = Count()
        self.known = {}

    def start(self):
        """Return the Server, having run it once without a fault."""
        server = Server(self.target, self.injector, self.folder, self.scratch)
        for exists in (False, True):
            before = self.begin(exists)
            ended = server.run(NONE)
            assert ended.code == 0, ended
            after = contents(self.folder / "out", self.own)
            grows = self.target.name == "dataset"
            self.known[exists] = Known(before, after, str(self.folder), grows)
        return server

    @property
    def own(self):
        """Return the names of folders in out/ that are the target's own affair."""
        return (".cg2raw",) if self.target.name == "dataset" else ()

    def begin(self, exists):
        """Empty the folders that are written; return what is there before."""
        empty(self.folder / "out")
        self.target.begin(self.folder, exists)
        return contents(self.folder / "out")

    def one(self, server, call, number, nth, sticky, exists, tmpfile=True):
        """Run once; return whether the fault was met."""
        self.begin(exists)
        ended = server.run(words_of(call, number, nth, sticky, tmpfile))
        self.count.tries += 1
        if not self.injector.fired:
            return False
        self.count.fired += 1
        found = contents(self.folder / "out", self.own)
        known = self.known[exists]
        if self.target.name == "dataset" and ended.code:
            # Images that could not be read are missing in the manifest, or it is.
            known = replace(known, after=dict(known.after))
            for name in ("manifest.jsonl", "manifest.parquet"):
                found.pop(name, None)
                known.after.pop(name)
        # Of a program's memory that all is gone is said by what is left of it.
        silent = call == "malloc" and (sticky or self.target.is_program)
        wrong = faults_of(ended, found, known, silent)
        if list((self.scratch / "tmp").iterdir()):
            wrong.append("leaves a temporary folder")
            empty(self.scratch / "tmp")
        if self.target.name == "dataset":
            wrong += self.gone_on_with(server, self.known[exists])
        if wrong:
            name = errno.errorcode.get(number, "")
            how = f"{call} {name} {nth}{' sticky' if sticky else ''}"
            where = "old file" if exists else "no file"
            line = f"{self.target.name}: {how}, {where}: {'; '.join(wrong)}"
            self.count.findings.append(f"{line}: {' '.join(ended.text.split())[-300:]}")
        return True

    def gone_on_with(self, server, known):
        """Return what is wrong with a data set when the same command has gone on."""
        ended = server.run(NONE)
        found = contents(self.folder / "out", self.own)
        if ended.code != 0 or found != known.after:
            return [f"does not go on: {ended.text[-200:]}"]
        return []

    def all(self, server, steps, tell=lambda line: None):
        """Walk the faults of some calls; steps as for walked()."""
        for call, (stride, most) in steps.items():
            before = self.count.fired
            for number, sticky, exists in self.ways(call):
                last = self.first + most * stride
                for nth in range(self.first, last, stride):
                    if not self.one(server, call, number, nth, sticky, exists):
                        break
            tell(f"{self.target.name} {call}: {self.count.fired - before} met")

    def ways(self, call):
        """Yield (errno, sticky, whether there are old files) in which a call fails."""
        for name in CALLS[call][: self.errors]:
            number = getattr(errno, name, 0)
            for sticky in (False, True):
                if call == "malloc" or self.target.name == "dataset":
                    yield number, sticky, not sticky
                else:
                    yield number, sticky, False
                    yield number, sticky, True


def walked(target, library, steps, tell=lambda line: None, first=1, errors=None):
    """Return the Count of a target's walk.

    steps : {call: (stride, most)}; every how many-th is tried, from the @first on, and
    how many at most. errors : how many of those that a call fails with; None: all."""
    with tempfile.TemporaryDirectory(prefix="cg2raw-faults.") as scratch:
        walk = Walk(target, library, Path(os.path.realpath(scratch)))
        walk.first, walk.errors = first, errors
        with walk.start() as server:
            walk.all(server, steps, tell)
        return walk.count


def alike(findings):
    """Yield the first of findings that differ in numbers alone, and how many more."""
    kinds = {}
    for finding in findings:
        kinds.setdefault(re.sub(r"\d+|sticky|once", "", finding), []).append(finding)
    for same in kinds.values():
        more = f" (and {len(same) - 1} alike)" if len(same) > 1 else ""
        yield f"{same[0]}{more}"


def tell(line):
    """Print progress."""
    print(line, file=sys.stderr, flush=True)


def main(words=None):
    """Walk what is asked for; return 1 if something was found."""
    parser = argparse.ArgumentParser(prog="scripts/faults", description=__doc__)
    add = parser.add_argument
    add("targets", nargs="*", metavar="COMMAND", help=f"of {', '.join(TARGETS)}")
    add("--fault", action="append", choices=list(CALLS), help="default: all of them")
    add("--stride", type=int, default=1, help="every how many-th call; default: 1")
    add("--first", type=int, default=1, help="of the calls that fail; default: 1")
    add("--most", type=int, default=10**6, help="calls of a kind; default: all")
    arguments = parser.parse_args(words)
    unknown = set(arguments.targets) - set(TARGETS)
    if unknown:
        parser.error(f"{unknown.pop()}: is none of {', '.join(TARGETS)}")
    total = Count()
    with tempfile.TemporaryDirectory(prefix="cg2raw-injector.") as folder:
        library = compiled(Path(folder))
        for name in arguments.targets or TARGETS:
            step = (arguments.stride, arguments.most)
            steps = dict.fromkeys(arguments.fault or CALLS, step)
            count = walked(TARGETS[name], library, steps, tell, arguments.first)
            for line in alike(count.findings):
                print(line)
            words = f"{count.tries} runs, {count.fired} faults met"
            print(f"{name}: {words}, {len(count.findings)} findings", flush=True)
            total.tries += count.tries
            total.fired += count.fired
            total.findings += count.findings
    words = f"{total.tries} runs, {total.fired} faults met"
    print(f"all: {words}, {len(total.findings)} findings")
    return 1 if total.findings else 0


if __name__ == "__main__":
    sys.exit(main())
