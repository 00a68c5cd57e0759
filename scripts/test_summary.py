# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Count the tests of a run: C++ tests one by one, and those inside each pytest folder.

    python scripts/test_summary.py build/system/Testing

Exits 1 if a test failed or none ran.
"""

import os
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

OUTCOMES = ("passed", "failed", "skipped")


def outcome(case):
    """Return the outcome of one JUnit <testcase>."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    if case.find("skipped") is not None or case.get("status") in ("notrun", "disabled"):
        return "skipped"
    return "passed"


def cases_of(file):
    """Return the <testcase> elements of @file, without ctest's of whole pytest runs."""
    cases = ElementTree.parse(file).getroot().iter("testcase")
    return [case for case in cases if not case.get("name").startswith("pytest.")]


def main(folder):
    """Print the table; return the exit code."""
    total, reasons, failures = Counter(), Counter(), []
    for file in sorted(folder.glob("*.xml"), key=lambda path: path.name != "ctest.xml"):
        name = "C++ and CMake" if file.stem == "ctest" else file.stem
        counts = Counter()
        for case in cases_of(file):
            result = outcome(case)
            counts[result] += 1
            if result == "skipped" and (skipped := case.find("skipped")) is not None:
                # What differs from test to test follows the colon.
                reasons[(skipped.get("message") or "skipped").split(": ")[0]] += 1
            if result == "failed":
                failures.append(f"{name}: {case.get('classname')}.{case.get('name')}")
        total += counts
        print_row(name, counts)
    print_row("total", total)
    for reason, count in reasons.most_common():
        print(f"  {count} skipped: {reason}")
    if os.environ.get("CG2RAW_TEST_SLOW") != "1":
        print("  slow tests are left out; scripts/test --slow runs them too")
    for failure in failures:
        print(f"  FAILED {failure}")
    return 1 if total["failed"] or not total["passed"] else 0


def print_row(name, counts):
    """Print one line of the table."""
    print(f"{name:24}" + "".join(f"{counts[key]:6} {key}" for key in OUTCOMES))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
