# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The bench of `cg2raw diagnose` runs, on frames far smaller than its own."""

import pytest

from studies.bench import diagnose


@pytest.mark.slow
def test_seconds_memory_and_what_was_found_are_printed(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(diagnose, "SIZES", {"tiny": (300, 210, 1, 30, None)})
    for _ in range(2):  # the second writes over the report of the first
        diagnose.bench(tmp_path)
        lines = capsys.readouterr().out.splitlines()
        assert lines[-1].startswith("tiny") and "lens_shading" in lines[-1]
