# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is kept of results tells what all of them tell, and says by what it was made."""

import numpy as np
import pytest

from studies.summaries import (
    committed_text,
    draws_in,
    read_committed,
    reduced,
    summaries,
    summary_of,
)
from studies.tasks.angles import summary
from studies.tasks.paired import difference


def test_differences_of_what_is_kept_are_those_of_all_values():
    """To the 4 decimals that are kept."""
    rng = np.random.default_rng(1)
    one, other = rng.random((5, 40)), rng.random((5, 40)) + 0.1
    whole = difference(one, other)
    kept = difference(reduced(one.tolist()), reduced(other.tolist()))
    assert kept.mean == pytest.approx(whole.mean, abs=1e-4)
    assert kept.error == pytest.approx(whole.error, abs=1e-4)


def test_frames_have_their_summary_and_number():
    errors = np.random.default_rng(2).random(40)
    kept = reduced(errors.tolist())
    assert kept["frames"] == 40
    assert summary_of(kept).worst == pytest.approx(summary(errors).worst, abs=1e-4)


def test_frames_of_the_first_measure_alone_are_kept(planted):
    for name, of in (("isp", "difference"), ("denoising", "psnr")):
        for entry in planted.summaries[name]["cameras"].values():
            for sources in entry.values():
                for measures in sources.values():
                    kept = [m for m, values in measures.items() if "frames" in values]
                    assert kept == [of]
            assert draws_in(entry) == 2


def test_a_file_of_summaries_is_read_as_it_was_written(planted, tmp_path):
    path = tmp_path / "evidence.json"
    path.write_text(committed_text(planted.summaries))
    assert read_committed(path) == planted.summaries
    assert read_committed(tmp_path / "missing.json") == {}
    path.write_text(committed_text(planted.summaries)[:500])
    with pytest.raises(ValueError, match="is no file of summaries") as refused:
        read_committed(path)
    assert "\n" not in str(refused.value)


def test_each_study_says_by_what_it_was_made(planted):
    for name, study in summaries(planted.results).items():
        assert study["made by"] == planted.results[name]["made by"]
