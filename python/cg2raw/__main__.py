# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command cg2raw, and python -m cg2raw: signals are answered before all else."""

import sys


def main() -> int:
    """Run the command line of this process; return its exit code."""
    from cg2raw.interrupts import answer_signals, ignore_signals

    answer_signals()
    if sys.stdout is not None:  # a signal ends the process without a flush
        sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    try:
        from cg2raw import cli

        return cli.main()
    finally:
        ignore_signals()


if __name__ == "__main__":
    sys.exit(main())
