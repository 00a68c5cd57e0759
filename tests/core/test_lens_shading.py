# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""lens_shading is the polynomial that it says, of lenses that are round or not."""

import numpy as np
import pytest

import cg2raw
from oracles.cameras import profile_text
from oracles.lens import irregular_terms
from oracles.scenes import scene

PARAMETERS = {
    parameter["name"]: parameter
    for effect in cg2raw.effects()
    if effect["name"] == "lens_shading"
    for parameter in effect["parameters"]
}


def field(height, width):
    """Return (u, v), half diagonals from the centre."""
    half = np.hypot(width, height) / 2.0
    v = (np.arange(height)[:, None] + 0.5 - height / 2.0) / half
    u = (np.arange(width)[None, :] + 0.5 - width / 2.0) / half
    return u, v


def shaded_by(rgb, parameters=None):
    """Return the signal of a scene (H, W, 3), shaded where there are parameters."""
    shading = [{"name": "lens_shading", "parameters": parameters}]
    text = profile_text(effects=shading if parameters else [])
    signal = cg2raw.Sensor.from_json(text).signal(rgb, illuminant="D50")
    return np.asarray(signal, float)


@pytest.mark.parametrize("size", [(40, 60), (41, 61), (200, 3)])
def test_lens_shading_is_its_polynomial(size):
    values = {"r2": -0.5, "r4": 0.3, "r6": -0.1, "tilt_x": 0.05, "tilt_y": -0.02}
    values |= {"tilt_x_r2": 0.07, "tilt_y_r2": -0.03}
    rgb = scene(*size)
    clean, shaded = shaded_by(rgb), shaded_by(rgb, values)
    u, v = field(*size)
    square = u**2 + v**2
    gain = 1.0 - 0.5 * square + 0.3 * square**2 - 0.1 * square**3 + 0.05 * u - 0.02 * v
    gain += square * (0.07 * u - 0.03 * v)
    assert shaded == pytest.approx(clean * gain, abs=1e-6)


def test_lens_shading_of_a_lens_that_is_not_round():
    """Its terms are all other powers of the place up to the sixth, in polar form."""
    round_lens = {"r2": -0.3, "r4": 0.1, "r6": 0.0, "tilt_x": 0.0, "tilt_y": 0.0}
    round_lens |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
    optional = {name for name, known in PARAMETERS.items() if known["optional"]}
    assert len(optional) == 20
    rgb = scene()
    u, v = field(*rgb.shape[:2])
    square = u**2 + v**2
    plain = shaded_by(rgb)
    of_round = 1 - 0.3 * square + 0.1 * square**2
    terms = irregular_terms(u, v)
    assert set(terms) == optional
    for name, term in terms.items():
        expected = plain * (of_round + 0.2 * term)
        assert shaded_by(rgb, {**round_lens, name: 0.2}) == pytest.approx(
            expected, abs=1e-6
        ), name


def test_lens_shading_never_turns_light_negative():
    values = {"r2": -2.0, "r4": 0.0, "r6": 0.0, "tilt_x": 0.5, "tilt_y": 0.5}
    values |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
    assert shaded_by(scene(), values).min() == 0.0


def test_what_a_round_lens_needs_is_not_optional():
    values = {"r2": -0.3, "r4": 0.1, "r6": 0.0, "tilt_x": 0.0, "tilt_y": 0.0}
    with pytest.raises(ValueError, match="tilt_x_r2 is missing"):
        shaded_by(scene(), values)
