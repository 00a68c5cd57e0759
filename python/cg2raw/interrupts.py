# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ctrl-C and SIGTERM end the command cg2raw by one line, at any moment of its life.

The process ends at once: no exception passes through modules that are half imported,
through callbacks of libraries, or an interpreter that shuts down. What must not be cut
in two is held(); what must not stay is removed by tidied(). Where cg2raw is imported by
another program, that program answers signals: held() and tidied() then do nothing."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
OF_SHELLS = 128  # what they add to the number of the signal that ended a process
# Where a progress bar was: an empty line, and the cursor that it had hidden.
AFTER_A_BAR = "\r\x1b[2K\x1b[?25h"


class Command:
    """What the answer to a signal depends on; of the main thread, which gets it."""

    process = 0  # whose signals are ours; 0: none
    sentence = ""  # what to say in the place of WORDS
    holds = 0
    waiting = 0  # a signal that came while something was held
    raises = False
    errors = 2  # descriptor of standard error

    def __init__(self) -> None:
        self.undo: list[Callable[[], None]] = []


_command = Command()


def answer_signals() -> None:
    """Answer for this process from now on: it is the command cg2raw."""
    _command.process = os.getpid()
    for number in WORDS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup asks for
            signal.signal(number, _answer)


def ignore_signals() -> None:
    """Let nothing end this process any more: its work is done, its exit code known."""
    for number in WORDS:
        signal.signal(number, signal.SIG_IGN)


def is_asked_to_end() -> bool:
    """Return whether a signal came while something is held."""
    return _command.waiting != 0


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Put off the end until the block is left: a file is written whole, or renamed."""
    if threading.current_thread() is not threading.main_thread():
        yield  # whoever waits for this thread holds
        return
    _command.holds += 1
    try:
        yield
    finally:
        _command.holds -= 1
        if _command.waiting and not _command.holds:
            _answer(_command.waiting, None)


@contextlib.contextmanager
def tidied(undo: Callable[[], None], sentence: str = "") -> Iterator[None]:
    """Call undo(), which may raise OSError, if a signal ends the process in the block.

    sentence : what is said then."""
    before = _command.sentence
    _command.sentence = sentence or before
    _command.undo.append(undo)
    try:
        yield
    finally:
        _command.undo.remove(undo)
        _command.sentence = before


@contextlib.contextmanager
def said_to(handle: int) -> Iterator[None]:
    """Let the last line go to a descriptor while standard error leads elsewhere."""
    _command.errors = handle
    try:
        yield
    finally:
        _command.errors = 2


@contextlib.contextmanager
def scratch_folder(prefix: str) -> Iterator[str]:
    """Yield a new temporary folder, which is gone afterwards, whatever ends it."""
    import tempfile

    with held():
        folder = tempfile.TemporaryDirectory(prefix=prefix)
        end = contextlib.ExitStack()
        end.enter_context(folder)
        end.enter_context(tidied(folder.cleanup))
    with end:
        yield folder.name


@contextlib.contextmanager
def raised() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt in the block, whose result is used then."""
    _command.raises = True
    try:
        yield
    finally:
        _command.raises = False


def _answer(number: int, frame: FrameType | None) -> None:
    if _command.holds:
        _command.waiting = number
    elif _command.raises and number == signal.SIGINT and not _is_importing(frame):
        _command.waiting = 0
        raise KeyboardInterrupt
    else:
        _end(number)


def _is_importing(frame: FrameType | None) -> bool:
    """Return whether a module is being imported: extensions turn exceptions over."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _end(number: int) -> None:
    code = OF_SHELLS + number
    if os.getpid() != _command.process:  # a fork; the command itself says it
        os._exit(code)
    ignore_signals()
    for undo in reversed(_command.undo):
        with contextlib.suppress(OSError):
            undo()
    word = sys.argv[1] if len(sys.argv) > 1 else "-"
    name = "cg2raw" if word.startswith("-") else f"cg2raw {word}"
    said = f"{name}: {_command.sentence or WORDS[signal.Signals(number)]}\n"
    with contextlib.suppress(OSError):
        errors = _command.errors
        bar = AFTER_A_BAR if "rich" in sys.modules and os.isatty(errors) else ""
        os.write(errors, (bar + said).encode(errors="backslashreplace"))
    os._exit(code)
