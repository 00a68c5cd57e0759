# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Progress of long work: a bar with the time that is left, on a terminal only."""

import contextlib
import os
import sys
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
def stages(quiet: bool = False) -> Iterator[Callable[[str, float], None]]:
    """Yield progress(words, share done 0..1) of work in stages: a bar on a terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda words, share: None
        return
    from rich.progress import Progress

    with Progress(console=console(), transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda words, share: bar.update(task, description=words, completed=share)


@contextlib.contextmanager
def counted(words: str, unit: str, total: int) -> Iterator[Callable[[int], None]]:
    """Yield progress(how many are done): on a terminal a bar with n/@total @unit and
    the time that is left."""
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    from rich import progress

    columns = (
        progress.TextColumn(words),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        progress.TextColumn(f"{unit},"),
        progress.TimeRemainingColumn(),
        progress.TextColumn("left"),
    )
    with progress.Progress(*columns, console=console(), transient=True) as bar:
        task = bar.add_task("", total=total)
        yield lambda done: bar.update(task, completed=done)
