# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the table of attributes in docs/oiiotool.md, from the options of the core.

    python scripts/attributes_table.py [--check] [PAGE]

With --check nothing is written: exits with 1 if the table is not what it would be.
"""

import argparse
import re
import sys
from pathlib import Path

from cg2raw import _core

ROOT = Path(__file__).resolve().parent.parent
HEAD = "| attribute | value | meaning |\n|---|---|---|\n"
TABLE = re.compile(re.escape(HEAD) + r"(?:\|.*\n)+")


def table():
    """Return the table, a line for each option."""
    return HEAD + "".join(
        f"| `dng:{name}` | {allowed} | {description} |\n"
        for name, _, allowed, description in _core.export_options()
    )


def main():
    """Write the page, or compare it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    parser.add_argument(
        "page", nargs="?", type=Path, default=ROOT / "docs" / "oiiotool.md"
    )
    arguments = parser.parse_args()
    before = arguments.page.read_text()
    if not TABLE.search(before):
        sys.exit(
            f"{arguments.page}: has no table that begins with {HEAD.splitlines()[0]}"
        )
    after = TABLE.sub(lambda _: table(), before, count=1)
    if arguments.check and before != after:
        sys.exit(f"{arguments.page} is not up to date: run scripts/attributes_table.py")
    if not arguments.check:
        arguments.page.write_text(after)


if __name__ == "__main__":
    main()
