# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Progress of long work: a bar with the time that is left, on a terminal only."""

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator, Sized
from typing import TypeVar

T = TypeVar("T")


MANY = 2  # items from which on a terminal shows progress


def tracked(
    items: Iterable[T],
    words: str,
    quiet: bool = False,
    many: int = MANY,
    total: int | None = None,
) -> Iterable[T]:
    """Return @items, with a bar on stderr if they are many and it is a terminal.

    total : how many they are, if they have no length."""
    count = total
    if count is None:
        assert isinstance(items, Sized)
        count = len(items)
    if quiet or count < many or not sys.stderr.isatty():
        return items
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    return track(items, words, count, console=console, transient=True)


@contextlib.contextmanager
def stages(quiet: bool = False) -> Iterator[Callable[[str, float], None]]:
    """Yield progress(words, share done 0..1) of work in stages: a bar on a terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda words, share: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda words, share: bar.update(task, description=words, completed=share)
