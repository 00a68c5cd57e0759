# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Progress of long work: a bar with the time that is left, on a terminal only."""

import contextlib
import os
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from rich.console import Console

T = TypeVar("T")


def console() -> "Console":
    """Return the terminal that stderr is, also while a library's words are kept from it
    (io.libraw)."""
    from rich.console import Console

    try:
        own = os.dup(sys.stderr.fileno())
    except (OSError, AttributeError):  # no file of the system
        return Console(stderr=True)
    return Console(file=os.fdopen(own, "w", encoding=sys.stderr.encoding))


MANY = 2  # items from which on a terminal shows progress


def tracked(
    items: Collection[T], words: str, quiet: bool = False, many: int = MANY
) -> Iterable[T]:
    """Return @items, with a bar on stderr if they are many and it is a terminal."""
    if quiet or len(items) < many or not sys.stderr.isatty():
        return items
    from rich.progress import track

    return track(items, words, len(items), console=console(), transient=True)


@contextlib.contextmanager
def stages(
    quiet: bool = False, verbose: int = 0
) -> Iterator[Callable[[str, float], None]]:
    """Yield progress(words, share done 0..1) of work in stages: on a terminal a bar
    with the time that is left; if @verbose, each stage as a line on stderr, if it is 2
    or more with the seconds since the start."""
    started, last = time.monotonic(), ""

    def line(words: str, share: float) -> None:
        nonlocal last
        if words != last:
            since = f"{time.monotonic() - started:8.1f} s  " if verbose > 1 else ""
            print(f"{since}{words}", file=sys.stderr)
        last = words

    if verbose:
        yield line
    elif quiet or not sys.stderr.isatty():
        yield lambda words, share: None
    else:
        with bar("", 1.0) as update:
            yield lambda words, share: update(share, words)


@contextlib.contextmanager
def counted(words: str, unit: str, total: int) -> Iterator[Callable[[int], None]]:
    """Yield progress(how many are done): on a terminal a bar with n/@total @unit and
    the time that is left."""
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    with bar(words, total, unit) as update:
        yield update


@contextlib.contextmanager
def bar(words: str, total: float, unit: str = "") -> Iterator[Callable[..., None]]:
    """Yield update(how much is done, words): a bar, with n/@total @unit if there is
    one, and the time that is left."""
    from rich import progress

    numbers = (progress.MofNCompleteColumn(), progress.TextColumn(f"{unit},"))
    columns = (
        progress.TextColumn("{task.description}"),
        progress.BarColumn(),
        *(numbers if unit else (progress.TaskProgressColumn(),)),
        progress.TimeRemainingColumn(),
        progress.TextColumn("left"),
    )
    with progress.Progress(*columns, console=console(), transient=True) as shown:
        task = shown.add_task(words, total=total)

        def update(done: float, words: str | None = None) -> None:
            shown.update(task, completed=done, description=words)

        yield update
