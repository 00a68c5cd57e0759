# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/performance.md: the numbers of `bench --all` take their place."""

import json
from pathlib import Path

import numpy as np

from studies.bench.dataset import paper_arguments, paper_raw, paper_raw_at_best

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "performance.md"
ROW = {
    "group": "oiiotool 3.2",
    "name": "DNG",
    "seconds": 0.25,
    "cpu_seconds": 0.4,
    "megapixels": 12.0,
    "peak_mb": 170.2,
    "file_mb": None,
    "ratio": 0.875,
    "cpu_ratio": 0.9,
}
ABOUT = {
    "date": "2026-11-26",
    "commit": "abc1234",
    "cores": 2,
    "processor": "a processor",
    "load": 0.1,
    "load_after": 1.2,
    "rounds": 7,
}


def test_the_peer_at_its_best_is_the_published_way():
    """Also where highlights are kept, and of rows that fill no block."""
    scene = np.random.default_rng(0).random((50, 64, 3), np.float32) * 1.2
    arguments = paper_arguments()
    best, way = (
        convert(scene, *arguments).astype(int)
        for convert in (paper_raw_at_best, paper_raw)
    )
    assert abs(best - way).max() <= 1 and len(np.unique(way)) > 500


def refreshed(run_module, page, folder, rows):
    """Return the text of a page after the script has put rows into it."""
    report = folder / "bench.json"
    report.write_text(json.dumps({"about": ABOUT, "rows": rows}))
    done = run_module("bench.page", report, "--page", page)
    assert done.returncode == 0, done.stderr
    return page.read_text()


def test_numbers_take_their_place(run_module, tmp_path):
    page = tmp_path / "page.md"
    page.write_text(PAGE.read_text())
    other = {**ROW, "group": "threads", "name": "2 threads", "ratio": None}
    text = refreshed(run_module, page, tmp_path, [ROW, other])
    assert "| DNG | 0.250 | 0.88 | 0.400 | 0.90 | 170 |  | 48 |" in text
    assert "| 2 threads | 0.250 |  | 0.400 |" in text
    assert text.index("### oiiotool 3.2") < text.index("### threads")
    assert "2 cores (a processor), load 0.1 before and 1.2 after" in text
    words = PAGE.read_text().partition("<!-- begin")[0]
    assert text.startswith(words)  # what people wrote stays
    again = refreshed(run_module, page, tmp_path, [ROW])
    assert again.count("| DNG |") == 1 and "### threads" not in again


def test_a_page_without_marks_is_left_alone(run_module, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# Mine\n")
    report = tmp_path / "bench.json"
    report.write_text(json.dumps({"about": ABOUT, "rows": [ROW]}))
    done = run_module("bench.page", report, "--page", page)
    assert done.returncode == 2 and "lacks the marks" in done.stderr
    assert page.read_text() == "# Mine\n"
