# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write docs/effects.md, docs/profile.md, docs/man, and the lists of attributes in
docs/oiiotool.md and in the stub of the core, from what the code says.

    python scripts/generate.py [--check] [ROOT]
"""

import argparse
import sys
from pathlib import Path

import attributes_table
import effects_page
import man_pages
import profile_page

ROOT = Path(__file__).resolve().parent.parent


def main():
    """Write or check all files; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    help = "write nothing: exit with 1 if a file is not what it would be"
    parser.add_argument("--check", action="store_true", help=help)
    parser.add_argument("root", nargs="?", default=ROOT, type=Path, help="of the files")
    arguments = parser.parse_args()
    code = 0
    for part in (attributes_table, effects_page, man_pages, profile_page):
        for name, text in part.texts(arguments.root).items():
            path = arguments.root / name
            if text == (path.read_text() if path.exists() else None):
                continue
            if arguments.check:
                print(f"{name} is not up to date: run scripts/generate.py")
                code = 1
            elif text is None:
                path.unlink()
            else:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
    return code


if __name__ == "__main__":
    sys.exit(main())
