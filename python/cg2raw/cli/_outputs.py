# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Output paths of a command."""

import argparse
import contextlib
import os
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any

from cg2raw.interrupts import held, is_asked_to_end

Pair = tuple[str, str]  # input, output
Report = dict[str, Any]


def to_file(path: str | None) -> bool:
    """Return whether an output goes to a file rather than to stdout."""
    return path not in (None, "-")


def check_output(option: str, path: str | None, ending: str) -> bool:
    """Return whether a path is that of a file, which may be there or not.

    Raises ValueError for another ending than @ending, and for a missing folder."""
    if path is None or not to_file(path):
        return False
    if os.path.exists(path) and not os.path.isfile(path):
        return False
    if os.path.splitext(path)[1].lower() != ending:
        raise ValueError(f"{option} {path}: must end in {ending}")
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise ValueError(f"{option} {path}: there is no folder {folder}")
    return True


def check_report(folder: str | None) -> None:
    """Raise ValueError for a --report that is a file, or that cannot be made."""
    if not folder:
        return
    parent = os.path.dirname(os.path.abspath(folder))
    if not os.path.isdir(parent):
        raise ValueError(f"--report {folder}: there is no folder {parent}")
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise ValueError(f"--report {folder}: is a file; name a folder")


def outputs_of(inputs: Sequence[str], output: str | None, ending: str) -> list[str]:
    """Return the path for each of @inputs: @output itself, or their stems in a folder.

    @output is a folder if it is one, ends in a slash, or inputs are several; it need
    not be there, what it lies in must. None is the current folder. Raises ValueError
    for an ending but @ending, for two inputs with one output, and for an output that is
    an input."""
    if output is None:
        output = os.curdir
    is_folder = os.path.isdir(output) or output.endswith(os.sep)
    if not is_folder and len(inputs) == 1:
        outputs = [output]
        if os.path.splitext(output)[1].lower() != ending:
            raise ValueError(f"-o {output}: must end in {ending}, or be a folder")
        folder = os.path.dirname(output) or os.curdir
        if not os.path.isdir(folder):
            raise ValueError(f"-o {output}: there is no folder {folder}")
    else:
        names = [stem_of(path) + ending for path in inputs]
        outputs = [os.path.normpath(os.path.join(output, name)) for name in names]
    check_apart(inputs, outputs)
    if outputs != [output]:
        check_folder(output)
    return outputs


def stem_of(path: str) -> str:
    """Return a file's name without its ending."""
    return os.path.splitext(os.path.basename(path))[0]


def check_apart(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Raise ValueError if two outputs are one file, or an output is an input."""
    first: dict[str, str] = {}
    read = {os.path.realpath(path): path for path in inputs}
    for path, output in zip(inputs, outputs, strict=True):
        real = os.path.realpath(output)
        if real in read:
            raise ValueError(f"-o {output}: is one of the files to be read")
        if real in first:
            raise ValueError(
                f"{path}: would become {output}, as {first[real]} does; give them "
                "different names or folders"
            )
        first[real] = path


def check_folder(folder: str) -> None:
    """Raise ValueError for a folder that is not there and cannot be made."""
    if os.path.isdir(folder):
        return
    if os.path.exists(folder):
        raise ValueError(f"-o {folder}: is no folder, and several files need one")
    parent = os.path.dirname(os.path.normpath(folder)) or os.curdir
    if not os.path.isdir(parent):
        raise ValueError(f"-o {folder}: there is no folder {parent}")


@contextlib.contextmanager
def folders_for(outputs: Sequence[str]) -> Generator[None]:
    """Make the folders of @outputs that are not there; of these, those that nothing was
    written to are gone afterwards."""
    made = []
    try:
        for folder in sorted({os.path.dirname(output) for output in outputs}):
            if folder and not os.path.isdir(folder):
                with contextlib.suppress(FileExistsError):  # another was faster
                    os.mkdir(folder)
                    made.append(folder)
        yield
    finally:
        for folder in made:
            with contextlib.suppress(OSError):  # it holds files
                os.rmdir(folder)


def each_file(
    name: str,
    pairs: Sequence[Pair],
    work: Callable[[str, str], Report],
    arguments: argparse.Namespace,
    words: str,
    line: Callable[[Report], str],
    faults: Sequence[tuple[str, str]] = (),
    workers: int = 1,
) -> int:
    """Call work(input, output) for all @pairs; print or report; return the exit code.

    A file that fails is named on stderr, the others are done, and the code is 1.
    line(report) is what is printed of one. faults : (input, message) of what failed
    before. workers : threads that work on a pair each."""
    import json
    import sys

    from cg2raw.cli._progress import tracked
    from cg2raw.short_messages import words_of

    reports, errors = [], []
    for path, text in faults:
        errors.append({"input": path, "error": text})
        print(f"cg2raw {name}: {text}", file=sys.stderr)
    with (
        folders_for([output for _, output in pairs]),
        held() if workers > 1 else contextlib.nullcontext(),
        contextlib.closing(results_of(pairs, work, workers)) as results,
    ):
        for path, _ in tracked(pairs, words, arguments.quiet):
            if is_asked_to_end():
                break
            try:
                reports.append(next(results)())
            except (ValueError, OSError, MemoryError) as error:
                text = words_of(error)
                text = text if str(path) in text else f"{path}: {text}"
                errors.append({"input": str(path), "error": text})
                print(f"cg2raw {name}: {text}", file=sys.stderr)
                continue
            if not (arguments.quiet or arguments.json):
                print(line(reports[-1]))
    if arguments.json:
        print(json.dumps({"files": reports, "errors": errors}, indent=2))
    failed = len(errors) - len(faults)
    if failed and len(pairs) > 1:
        print(f"cg2raw {name}: {failed} of {len(pairs)} failed", file=sys.stderr)
    return 1 if errors else 0


def results_of(
    pairs: Sequence[Pair], work: Callable[[str, str], Report], workers: int
) -> Generator[Callable[[], Report]]:
    """Yield for each of @pairs what returns its report, or raises.

    Closed early, it waits for the pairs that are begun; the others are not."""
    if workers == 1:
        yield from (partial(work, *pair) for pair in pairs)
        return
    with ThreadPoolExecutor(workers) as pool:
        # Let go one by one: an error holds the arrays of the work that it ended.
        waiting: deque[Future[Report]] = deque(
            pool.submit(work, *pair) for pair in pairs
        )
        try:
            while waiting:
                yield waiting.popleft().result
        finally:
            for future in waiting:
                future.cancel()
