#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make the bundled sensor profiles from published tables: same tables, same bytes.

The cameras stand in shelf/cameras_*.py. Run it with a Python that has cg2raw, which
reads the real DNGs among the data.
"""

import argparse
import sys
from pathlib import Path

from shelf import cameras_measured, cameras_paper
from shelf.profile import formatted, profile_of

CAMERAS = {**cameras_paper.CAMERAS, **cameras_measured.CAMERAS}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with tables/")
    parser.add_argument(
        "--out", type=Path, required=True, help="folder for the profiles"
    )
    arguments = parser.parse_args()
    tables = arguments.data / "tables"
    if not tables.is_dir():
        sys.exit(f"make_profiles: {arguments.data} has no folder tables/")
    made = {name: profile_of(name, entry, tables) for name, entry in CAMERAS.items()}
    for name, profile in made.items():
        (arguments.out / f"{name}.json").write_text(formatted(profile))


if __name__ == "__main__":
    main()
