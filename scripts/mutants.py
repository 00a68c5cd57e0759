# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Plant small faults in the Python package, one at a time; list those no test sees.

A fault meets the tests that run its line, in a scratch copy of the package: the tree
stays as it is. Which tests run which lines is measured once and kept in build/mutants,
with the verdicts: a second call goes on from there. What runs only in a process that a
signal ends is not measured.
"""

import argparse
import contextlib
import difflib
import hashlib
import itertools
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path, PurePath

import pytest

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("CG2RAW_BUILD", ROOT / "build/system"))
KEPT = ROOT / "build/mutants"
PACKAGES = ("python/cg2raw", "ocio/cg2raw_ocio")
TEST = "CG2RAW_MUTANTS_TEST"
# Seconds: what a test file may take when it is measured; what a fault may take besides
# five times the time of its tests.
MEASURING, START = 600, 30
COVERAGE = """[run]
include = {package}/*
data_file = {folder}/coverage
parallel = true
context = ${{{test}-}}
disable_warnings = no-data-collected,module-not-measured,couldnt-parse
"""


# As a plugin of pytest: each test is a context, also of the processes that it starts; a
# fixture that tests share is run for all of their file, FILE::
def pytest_runtest_logstart(nodeid):
    run_for(nodeid)


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef):
    test = os.environ[TEST]
    if fixturedef.scope != "function":
        run_for(test.partition("::")[0] + "::")
    try:
        return (yield)
    finally:
        run_for(test)


def run_for(context: str) -> None:
    from coverage import Coverage

    os.environ[TEST] = context
    Coverage.current().switch_context(context)


def pytest_runtest_logreport(report):
    with open(os.environ["CG2RAW_MUTANTS_LOG"], "a") as log:
        print(json.dumps([report.nodeid, report.outcome, report.duration]), file=log)


def digest(*parts: bytes) -> str:
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:20]


class Scratch:
    """A build folder with a copy of the package, which goes with the process."""

    def __init__(self, folder: str) -> None:
        self.folder = Path(folder)
        self.build = self.folder / "build"
        self.package = self.build / "lib/python"
        shutil.copytree(
            BUILD / "lib/python",
            self.package,
            ignore=shutil.ignore_patterns("__pycache__"),
        )
        for folder in (BUILD, BUILD / "lib"):
            for entry in folder.iterdir():
                link = self.build / entry.relative_to(BUILD)
                if not link.exists():
                    link.symlink_to(entry)

    def copy_of(self, path: str) -> Path:
        """Return where the scratch copy of a source of the tree lies."""
        return self.package / path.partition("/")[2]

    def pytest(self, words, seconds: float, coverage=False, **variables) -> tuple:
        """Run pytest; return its exit code (None: time limit) and its output."""
        environment = {
            **os.environ,
            "CG2RAW_BUILD": str(self.build),
            "PYTHONPATH": f"{self.package}{os.pathsep}{ROOT / 'scripts'}",
            "PYTHONDONTWRITEBYTECODE": "" if coverage else "1",
            "OPENBLAS_NUM_THREADS": "1",
            **variables,
        }
        tests = self.folder / "tests"
        measured = ["-m", "coverage", "run", f"--rcfile={self.folder / 'rc'}"]
        command = [sys.executable, *(measured if coverage else []), "-m", "pytest"]
        with subprocess.Popen(
            [*command, "-q", "--no-header", "--tb=no", f"--basetemp={tests}", *words],
            cwd=ROOT,
            env=environment,
            text=True,
            errors="replace",
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as process:
            try:
                output, _ = process.communicate(timeout=seconds)
                return process.returncode, output
            except subprocess.TimeoutExpired:
                return None, ""
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)

    def measure(self, test_file: str) -> dict:
        """Run a test file; return the tests that pass, and the lines that each runs."""
        from coverage import CoverageData
        from coverage.exceptions import DataError

        log = self.folder / "log"
        log.write_text("")
        rc = COVERAGE.format(package=self.package, folder=self.folder, test=TEST)
        (self.folder / "rc").write_text(rc)
        variables = {
            "CG2RAW_MUTANTS_LOG": str(log),
            "COVERAGE_PROCESS_START": str(self.folder / "rc"),
        }
        self.pytest([test_file, "-p", "mutants"], MEASURING, True, **variables)
        seconds, failed, skipped = defaultdict(float), set(), set()
        for line in log.read_text().splitlines():
            test, outcome, duration = json.loads(line)
            seconds[test] += duration
            if outcome != "passed":
                failed.add(test)
            if outcome == "skipped":
                skipped.add(test)
        tests = {test: s for test, s in seconds.items() if test not in failed}
        # What one test of the file works out for another, runs for each of them.
        caches = "@cache" in (ROOT / test_file).read_text()
        lines: dict = defaultdict(lambda: defaultdict(set))
        for file in self.folder.glob("coverage.*"):
            with contextlib.suppress(DataError):  # of a process that a test killed
                data = CoverageData(file)
                data.read()
                for path in data.measured_files():
                    source = Path(path).relative_to(self.package).as_posix()
                    for line, contexts in data.contexts_by_lineno(path).items():
                        shared = caches or f"{test_file}::" in contexts
                        for test in tests if shared else tests.keys() & set(contexts):
                            lines[source][test].add(line)
            file.unlink()
        return {
            "tests": tests,
            "failed": len(failed - skipped),
            "lines": {
                source: {test: sorted(some) for test, some in of.items()}
                for source, of in lines.items()
            },
        }


class Coverage:
    """What tests run which lines: {source: {test: lines}}, and the seconds of tests."""

    def __init__(self, scratch: Scratch, test_files, kept_in: Path, track) -> None:
        self.seconds: dict[str, float] = {}
        self.lines: dict = defaultdict(dict)
        self.digests: dict[str, str] = {}
        folder = kept_in / "tests"
        folder.mkdir(parents=True, exist_ok=True)
        for test_file in track(test_files, "tests measured"):
            kept = folder / (test_file.replace("/", ".") + ".json")
            record = json.loads(kept.read_text()) if kept.exists() else None
            if record is None or not self.is_current(scratch, test_file, record):
                record = scratch.measure(test_file)
                if failed := record.pop("failed"):
                    print(
                        f"{test_file}: {failed} tests fail without a fault", flush=True
                    )
                record["digests"] = self.digests_of(scratch, test_file, record)
                kept.write_text(json.dumps(record))
            self.seconds |= record["tests"]
            self.digests[test_file] = record["digests"][test_file]
            for source, tests in record["lines"].items():
                self.lines[source] |= tests

    @staticmethod
    def digests_of(scratch, test_file, record) -> dict[str, str]:
        found = {test_file: digest((ROOT / test_file).read_bytes())}
        for source in record["lines"]:
            path = scratch.package / source
            found[source] = digest(path.read_bytes()) if path.exists() else ""
        return found

    def is_current(self, scratch, test_file, record) -> bool:
        return record["digests"] == self.digests_of(scratch, test_file, record)

    def tests_of(self, source: str, lines: range | None) -> list[str]:
        """Return the tests that run some of the lines, of the folder that mirrors the
        source's first, then quick files first; None, of what a module says once: any
        line of the sources of its folder, which may read it."""
        inside = source.partition("/")[2]
        files: dict[str, set[str]] = defaultdict(set)
        folder = PurePath(inside).parent
        near = [one for one in self.lines if PurePath(one).parent == folder]
        for one in [inside] if lines else near:
            for test, those in self.lines[one].items():
                if lines is None or any(line in lines for line in those):
                    files[test.partition("::")[0]].add(test)
        mirror = PurePath("tests", *PurePath(inside).parts[1:-1])

        def order(file: str) -> tuple[bool, float]:
            cost = sum(map(self.seconds.get, files[file]))
            return not PurePath(file).is_relative_to(mirror), cost

        return [test for f in sorted(files, key=order) for test in sorted(files[f])]


def judge(scratch: Scratch, path: str, mutation, tests: list[str], seconds) -> str:
    """Return what became of a fault: "survived", or what saw it.

    seconds : what the tests take without it."""
    source = source_of(path)
    copy = scratch.copy_of(path)
    for compiled in copy.parent.glob(f"__pycache__/{copy.stem}.*"):
        compiled.unlink()
    words = scratch.folder / "words"
    words.write_text("\n".join(tests))
    copy.write_bytes(mutation.apply(source))
    try:
        code, output = scratch.pytest(["-x", f"@{words}"], START + 5 * seconds)
    finally:
        copy.write_bytes(source)
    if code is None:
        return "time limit"
    if code == 0:
        return "survived"
    seen = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", output, re.M)
    return seen[1] if seen else f"exit code {code}"


def source_of(path: str) -> bytes:
    return (ROOT / path).read_bytes()


def faults_of(path: str, lines: set[int] | None) -> list:
    """Return [(path, mutation)] of a source, of some of its lines or all."""
    from mutation_operators import mutations

    found = mutations(source_of(path))
    return [(path, m) for m in found if lines is None or m.line in lines]


def git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"mutants: {done.stderr.strip().splitlines()[0]}")
    return done.stdout


def changed_lines(revision: str) -> dict[str, set[int]]:
    """Return the lines of the package that differ from a revision."""
    found: dict[str, set[int]] = defaultdict(set)
    path = ""
    for line in git("diff", "-U0", revision, "--", *PACKAGES).splitlines():
        if line.startswith("+++ "):
            path = line.removeprefix("+++ b/")
        elif hunk := re.match(r"@@ \S+ \+(\d+)(?:,(\d+))? @@", line):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            found[path] |= set(range(first, first + count))
    return found


def chosen(arguments) -> list:
    """Return the faults to plant, in the order of the sources."""
    sources = git("ls-files", "-co", "--exclude-standard", "--", *PACKAGES).splitlines()
    sources = [s for s in sources if s.endswith(".py") and (ROOT / s).exists()]
    lines: dict = dict.fromkeys(sources)
    if arguments.changed is not None:
        changed = changed_lines(arguments.changed)
        lines = {path: changed[path] for path in sources if path in changed}
    elif arguments.folders:
        asked = [os.path.normpath(folder) for folder in arguments.folders]
        for folder in asked:
            if not any(Path(path).is_relative_to(folder) for path in sources):
                sys.exit(
                    f"mutants: {folder}: no Python source of {' or '.join(PACKAGES)}"
                )
        lines = {
            path: None
            for path in sources
            if any(Path(path).is_relative_to(folder) for folder in asked)
        }
    faults = [fault for path in lines for fault in faults_of(path, lines[path])]
    order = random.Random(arguments.seed).sample(range(len(faults)), len(faults))
    sound = (i for i in order if faults[i][1].compiles(source_of(faults[i][0])))
    return [faults[index] for index in sorted(itertools.islice(sound, arguments.n))]


def difference(path: str, mutation) -> str:
    """Return the fault as a diff without context."""
    source = source_of(path)
    sides = (text.decode().splitlines() for text in (source, mutation.apply(source)))
    lines = list(difflib.unified_diff(*sides, n=0, lineterm=""))[3:]
    return "\n".join(["    " + line for line in lines])


def verdicts(scratch: Scratch, coverage: Coverage, faults, folder: Path, track):
    """Yield (path, mutation, verdict) of each fault; what is known already is kept.

    That a fault was seen holds for its source; that it was not, also for its tests."""
    kept = folder / "verdicts.jsonl"
    known = (
        dict(map(json.loads, kept.read_text().splitlines())) if kept.exists() else {}
    )
    with open(kept, "a") as log:
        for path, mutation in track(faults, "faults planted"):
            seen = digest(source_of(path), repr(mutation).encode())
            tests = coverage.tests_of(path, mutation.lines)
            files = sorted({test.partition("::")[0] for test in tests})
            state = json.dumps([tests, [coverage.digests[file] for file in files]])
            missed = digest(seen.encode(), state.encode())
            verdict = known.get(seen) or known.get(missed)
            if verdict is None:
                began = time.monotonic()
                verdict = "no test"
                if tests:
                    seconds = sum(map(coverage.seconds.get, tests))
                    verdict = judge(scratch, path, mutation, tests, seconds)
                key = missed if verdict in ("survived", "no test") else seen
                took = round(time.monotonic() - began, 1)
                print(json.dumps([key, verdict]), file=log, flush=True)
                print(f"{path}:{mutation.line} {verdict} ({took} s)", flush=True)
            yield path, mutation, verdict


def parsed(words=None) -> argparse.Namespace:
    def positive(text: str) -> int:
        if (number := int(text)) < 1:
            raise ValueError
        return number

    parser = argparse.ArgumentParser(prog="scripts/mutants", description=__doc__)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--changed", metavar="REV", help="lines that differ from REV")
    which.add_argument(
        "folders",
        nargs="*",
        default=[],
        metavar="FOLDER",
        help="folders or files of the package; else all of it",
    )
    parser.add_argument("-n", type=positive, default=200, help="faults; %(default)s")
    parser.add_argument(
        "--seed", type=int, default=1, help="of their choice; %(default)s"
    )
    parser.add_argument(
        "--least",
        type=float,
        default=0.85,
        metavar="SHARE",
        help="exit code 1 if tests see less; %(default)s",
    )
    parser.add_argument(
        "--tests",
        action="append",
        metavar="FILE",
        help="test file to run, again for more; else all but slow tests",
    )
    parser.add_argument(
        "--kept",
        type=Path,
        default=KEPT,
        metavar="FOLDER",
        help="where measurements and verdicts are kept; build/mutants",
    )
    return parser.parse_args(words)


def main() -> int:
    from rich.console import Console
    from rich.progress import Progress

    arguments = parsed()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if not (BUILD / "lib/python/cg2raw").is_dir():
        sys.exit(f"mutants: {BUILD}/lib/python has no package: run scripts/setup")
    try:
        import coverage  # noqa: F401
    except ImportError:
        sys.exit("mutants: coverage is not installed: run scripts/setup")
    faults = chosen(arguments)
    if not faults:
        print("mutants: there is nothing to change")
        return 0
    tests = (
        arguments.tests
        or git("ls-files", "tests/test_*.py", "tests/**/test_*.py").split()
    )
    survivors = []
    with (
        tempfile.TemporaryDirectory(prefix="cg2raw-mutants-") as folder,
        Progress(console=Console(stderr=True)) as progress,
    ):

        def track(items, text):
            return progress.track(items, description=text)

        scratch = Scratch(folder)
        measured = Coverage(scratch, tests, arguments.kept, track)
        for path, mutation, verdict in verdicts(
            scratch, measured, faults, arguments.kept, track
        ):
            if verdict in ("survived", "no test"):
                survivors.append((path, mutation, verdict))
    for path, mutation, verdict in survivors:
        print(f"{path}:{mutation.line}: {verdict}\n{difference(path, mutation)}")
    share = 1 - len(survivors) / len(faults)
    print(f"{len(faults)} faults, {len(survivors)} unseen: {share:.1%} seen")
    return 0 if share >= arguments.least else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
