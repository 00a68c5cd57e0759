# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command cg2raw, and python -m cg2raw: signals are answered before all else."""

import os
import sys


def open_standard_streams() -> None:
    """Let nothing be printed where whoever started the process closed a stream.

    Its number would be the next file's, a DNG's, and what libraries print would go
    there; this process's own prints would fail."""
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(handle, True)
    os.close(handle)
    sys.stdin = sys.stdin or open(os.devnull)  # noqa: SIM115
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115


def main() -> int:
    """Run the command line of this process; return its exit code."""
    from cg2raw.interrupts import answer_signals, ignore_signals

    answer_signals()
    open_standard_streams()
    # A signal ends the process without a flush.
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    try:
        from cg2raw import cli

        return cli.main()
    finally:
        ignore_signals()


if __name__ == "__main__":
    sys.exit(main())
