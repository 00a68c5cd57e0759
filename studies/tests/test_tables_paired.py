# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What stands above tables of paired differences."""

import numpy as np

from studies.tables_isp import isp_tables
from studies.tables_paired import BASELINES, FLOOR, OWN, REAL, extent


def test_cameras_with_unlike_numbers_of_draws_are_told():
    of = [np.zeros((5, 60)), np.zeros((3, 60))]
    assert extent(of) == "3 to 5 draws, 60 test frames a camera"
    assert extent(of[:1], "seeds") == "5 seeds, 60 test frames a camera"


def test_a_table_of_a_study_that_was_interrupted_says_so():
    rng = np.random.default_rng(0)

    def entry(draws):
        values = {m: rng.random((draws, 4)) for m in ("difference", "psnr")}
        return dict.fromkeys((REAL, FLOOR, OWN, "ours, paper", *BASELINES), values)

    text = isp_tables({"nikon-d850": entry(4), "sony-a7s-ii": entry(2)})
    assert text.startswith("### Neural ISP, 2 to 4 draws, 4 test frames a camera\n")
