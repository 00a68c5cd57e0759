# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""studies.spectra: what it reads, best matrices, the page it is on."""

import numpy as np
import pytest

from cg2raw.profile.matrix_fit import training_reflectances
from cg2raw.profile.spectral_file import WAVELENGTHS
from studies.spectra import best_matrix, data


def spectra_of(count, seed=1):
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 0.9, (count, len(WAVELENGTHS)))


def test_tables_of_both_forms_are_read(tmp_path):
    rows = spectra_of(3)
    table = np.column_stack([WAVELENGTHS, rows.T])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",")
    np.savez(tmp_path / "a.npz", table.T)
    for name in ("a.csv", "a.npz"):
        found = data.read_reflectances(tmp_path / name)
        assert found == pytest.approx(rows, abs=1e-12)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (["420,0.5", "700,0.5"], "cover 400 to 700 nm"),
        (["400,0.5", "390,0.5", "710,0.5"], "must rise"),
        (["400,0.5", "700,1.5"], "reflectances of 0 to 1.1"),
        (["400,nan", "700,0.5"], "reflectances of 0 to 1.1"),
        (["400", "700"], "must hold reflectances"),
        (["nm,white"], "nm"),
    ],
)
def test_other_tables_are_one_error(tmp_path, rows, message):
    path = tmp_path / "a.csv"
    path.write_text("\n".join(rows))
    with pytest.raises(ValueError, match=message):
        data.read_reflectances(path)


def test_what_a_fit_has_seen_is_left_out():
    """And what stands there twice, and what has no colour."""
    fresh, training = spectra_of(5), np.array(training_reflectances())
    rows = np.concatenate(
        [fresh, fresh[:2], np.full((3, 81), 1e-3), training[[7]] * 1.001]
    )
    kept, left_out = data.usable(rows)
    assert np.array_equal(kept, fresh)
    assert left_out == {"black": 3, "twice": 2, "training": 1}


def test_the_least_angle_is_no_more_than_that_of_least_squares():
    rng = np.random.default_rng(4)
    rgb = rng.uniform(0.02, 1.0, (200, 3))
    exact = rgb @ rng.uniform(0.1, 1.0, (3, 3))
    truth = exact * rng.uniform(0.5, 1.5, (200, 1))  # brightness says nothing
    assert best_matrix.angles(truth, best_matrix.least_angle(rgb, truth)).max() < 1e-6
    noisy = truth + rng.normal(0, 0.01, truth.shape)
    means = [
        best_matrix.angles(noisy, fit(rgb, noisy)).mean()
        for fit in (best_matrix.least_angle, best_matrix.least_squares)
    ]
    assert means[0] < means[1]


@pytest.mark.slow
def test_the_page_has_what_the_command_prints(camera_data, repository, run_module):
    """The rows of one camera, to the digit."""
    words = ("--data", camera_data, "--cameras", "EOS_600D")
    done = run_module("spectra.study", *words)
    assert done.returncode == 0, done.stderr
    printed = [line for line in done.stdout.splitlines() if line.startswith("| 600D")]
    page = (repository / "docs/spectral-evidence.md").read_text().splitlines()
    assert len(printed) == 5 and set(printed) <= set(page)
