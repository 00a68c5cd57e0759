# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What may lift images in place of a black level, of known numbers."""

import numpy as np
import pytest

from cg2raw.diagnose.scenes.black_level import others_that_lift
from cg2raw.model.dark_levels import CURRENT, DRIFT

AGREE = (-0.01, 0.0, 0.01)


@pytest.mark.parametrize(
    ("levels", "deviations", "others"),
    [
        ([1.0, 1.0, 1.0, 1.0], AGREE, {CURRENT}),
        ([1.2, 0.9, 0.9, 1.0], AGREE, {CURRENT}),  # within errors of 0.1
        ([1.5, 0.8, 0.8, 0.9], AGREE, set()),
        ([-1.0, -1.0, -1.0, -1.0], AGREE, set()),  # no current is
        ([1.0], AGREE, {CURRENT}),  # of a sensor without filters
        ([-1.0], (-0.9, 0.0, 0.9), {DRIFT}),
        ([-1.0], (-0.1, 0.1), {DRIFT}),  # t of two is 63.7 in one of 100
        ([-1.0], (-0.01, 0.01), set()),
        ([1.0], (-2.0, 2.0), {CURRENT, DRIFT}),
    ],
)
def test_what_scenes_do_not_agree_on_is_drift_and_what_is_even_a_current(
    levels, deviations, others
):
    information = 100 * np.eye(len(levels))
    found = others_that_lift(np.array(levels), information, np.array(deviations), 0.01)
    assert found == others
