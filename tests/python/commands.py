# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Commands run in this process, and DNGs of known cameras for them to read."""

import contextlib
import io
from dataclasses import dataclass

from cg2raw.cli import main
from dng import dng_files


@dataclass
class Done:
    """What a command printed and returned."""

    code: int
    out: str
    err: str


def run(*arguments):
    """Run cg2raw; an exception that leaves it fails the test, as a traceback would."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main([str(word) for word in arguments])
        except SystemExit as stop:
            code = stop.code
    return Done(code or 0, out.getvalue(), err.getvalue())


def fails(*arguments, code=1):
    """Run a command that must fail with one line; return that line."""
    done = run(*arguments)
    assert (done.code, done.out) == (code, ""), done
    line = done.err.splitlines()[-1]
    assert code == 2 or done.err.count("\n") == 1, done.err
    return line


def write_dng(path, illuminant="A", iso=None, shape=(16, 24), **fields):
    """Write a small DNG of a bundled camera with @fields changed; return its path."""
    profile = fields.pop("profile", "nikon-d40")
    sensor = dng_files.sensor(profile, **fields)
    dng_files.write(path, sensor, illuminant=illuminant, iso=iso, shape=shape)
    return path
