# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Drop-one: what is lost without an effect, and where."""

import pytest

from cg2raw.diagnose.assessment.drop_one import DropOne
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from diagnose.planted import ONE, READ, captures_of, drawn, frames_of, model_of
from diagnose.shaded import SENSOR, SHADING

TRUE = model_of(SENSOR, **SHADING, black_level=[2 * READ] * 4)


@pytest.fixture(scope="module")
def drop_one():
    frames = []
    for group in ("fit", "select"):
        captures = captures_of(("dark", "flat"), group)
        biases = captures_of(("dark",), group, exposure_time=0.0)
        renamed = [(f"bias-{group}", one) for one in biases]
        captures += [type(one)(**{**vars(one), "name": n}) for n, one in renamed]
        frames += drawn(frames_of(SENSOR, captures), TRUE, 7)
    return DropOne(fit(TRUE, Splits(frames, ONE).fit), Splits(frames, ONE))


def test_what_acts_on_light_alone_loses_little_elsewhere(drop_one):
    """But that others, fitted without it, fit darks a little worse."""
    elsewhere = drop_one.loss_elsewhere("lens_shading", "lens_shading")
    assert abs(elsewhere) < 0.2 * drop_one.loss("lens_shading")
