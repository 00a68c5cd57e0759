#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Put the numbers of `studies/run bench --all --json FILE` into docs/performance.md."""

import argparse
import json
from pathlib import Path

from studies.places import ROOT

PAGE = ROOT / "docs" / "performance.md"
BEGIN = "<!-- begin: numbers by studies/bench/page.py -->\n"
END = "<!-- end -->\n"
COLUMNS = ("seconds", "ratio", "cpu_seconds", "cpu_ratio", "peak_mb", "file_mb")
HEADS = ("", "s", "ratio", "CPU s", "ratio", "peak MB", "file MB", "MP/s")
FORMS = {
    "seconds": ".3f",
    "ratio": ".2f",
    "cpu_seconds": ".3f",
    "cpu_ratio": ".2f",
    "peak_mb": ".0f",
    "file_mb": ".1f",
}


def table(rows):
    """Return the Markdown table of the rows of a group."""
    lines = ["| " + " | ".join(HEADS) + " |", "|---" * len(HEADS) + "|"]
    for row in rows:
        cells = [row["name"]]
        cells += [format(row[c], FORMS[c]) if row[c] else "" for c in COLUMNS]
        cells.append(format(row["megapixels"] / row["seconds"], ".0f"))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def numbers(report):
    """Return the Markdown of a report."""
    about = report["about"]
    parts = [
        f"Measured on {about['date']} at {about['commit']}: {about['cores']} cores "
        f"({about['processor']}), load {about['load']} before and "
        f"{about['load_after']} after; medians of {about['rounds']} rounds."
    ]
    groups = dict.fromkeys(row["group"] for row in report["rows"])
    for group in groups:
        rows = [row for row in report["rows"] if row["group"] == group]
        parts += [f"### {group}", table(rows)]
    return "\n\n".join(parts) + "\n"


def main():
    """Rewrite what stands between the marks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("report", type=Path, help="JSON of studies/run bench --all")
    parser.add_argument("--page", type=Path, default=PAGE)
    arguments = parser.parse_args()
    text = arguments.page.read_text()
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        parser.error(f"{arguments.page} lacks the marks of the numbers")
    found = numbers(json.loads(arguments.report.read_text()))
    arguments.page.write_text(f"{before}{BEGIN}\n{found}\n{END}{after}")


if __name__ == "__main__":
    main()
