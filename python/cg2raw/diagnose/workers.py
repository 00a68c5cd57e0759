# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Workers: threads that work on frames, up to a deadline."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


class TimeIsUp(Exception):
    """The time that was given to a diagnosis has passed."""


class Workers:
    """Threads that work on frames; numpy and the registry let go of the interpreter.

    deadline : of time.monotonic(), from which on nothing new is begun; None: never."""

    def __init__(self, count: int, deadline: float | None = None) -> None:
        self._pool = ThreadPoolExecutor(count) if count > 1 else None
        self.deadline = deadline

    def map(
        self, work: Callable[[Item], Result], items: Sequence[Item]
    ) -> list[Result]:
        """Return the results, in order. Raises TimeIsUp after the deadline."""
        if self.deadline is not None and time.monotonic() > self.deadline:
            raise TimeIsUp
        if self._pool is None:
            return [work(item) for item in items]
        return list(self._pool.map(work, items))
