# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The table of attributes in docs/oiiotool.md, from the options of the core."""

import re
import sys

from cg2raw import _core

PAGE = "docs/oiiotool.md"
HEAD = "| attribute | value | meaning |\n|---|---|---|\n"
TABLE = re.compile(re.escape(HEAD) + r"(?:\|.*\n)+")


def table():
    """Return the table, a line for each option."""
    return HEAD + "".join(
        f"| `dng:{name}` | {allowed} | {description} |\n"
        for name, _, _, allowed, description in _core.export_options()
    )


def texts(root):
    """Return {path: text} of what is written below a root."""
    before = (root / PAGE).read_text()
    if not TABLE.search(before):
        sys.exit(f"{PAGE}: has no table that begins with {HEAD.splitlines()[0]}")
    return {PAGE: TABLE.sub(lambda _: table(), before, count=1)}
