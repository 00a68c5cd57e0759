# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Laws that every effect's file keeps: words, whitening, density, fit, way back."""

import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.catalogue import every, names
from diagnose.planted import capture_of, frames_of, sensor_of

SENSOR = sensor_of()
# Values that a handful of small frames show by far, and are in the middle of a range.
PLANTED = {
    "exposure": (0.05,),
    "white_balance": (0.05, -0.04),
    "color_matrix": (0.04, -0.02, 0.03, 0.02, -0.03, 0.02),
    "blur": (0.1, 0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    "color_shading": (0.06, 0.0, 0.0, 0.0, -0.05, 0.0, 0.0, 0.0),
    "lateral_chromatic_aberration": (0.5, -0.4, 0.0, 0.0),
    "lens_distortion": (0.6, -0.2),
    "lens_shading": (-0.2, -0.05, 0.0, 0.01, 0.0, 0.0, 0.0, *20 * (0.0,)),
    "veiling_glare": (0.03, 0.02),
    "crosstalk": (0.01, 0.02, 0.015, 0.01),
    "gr_gb_imbalance": (0.02, -0.01),
    "nonlinearity": (0.06, 0.02),
    "full_well": (0.55,),
    "black_level": (0.002, -0.001, 0.003, 0.001),
    "shot_noise": (0.4,),
    "read_noise": (0.5,),
}


@pytest.fixture(scope="module")
def frames():
    kinds = ("dark", "flat", "scene", "scene")
    captures = [capture_of(kind, n, level=0.7) for n, kind in enumerate(kinds)]
    return frames_of(SENSOR, captures)


@pytest.mark.parametrize("name", names())
def test_its_words_exist(name):
    effect = every()[name]
    assert effect.title and effect.where
    assert not effect.title.endswith(".") and not effect.where.endswith(".")
    one = Estimate(0.1, "1", (0.05, 0.15))
    size = effect.size(dict.fromkeys(effect.parameters, one))
    assert any(letter.isdigit() for letter in size) and not size.endswith(".")
    assert effect.signature <= {"gain", "mixer", "softener", "offset", "noise", "map"}
    assert set(effect.taken_up_by) <= set(names()) - {name}
    assert effect.shapes <= set(effect.parameters)
