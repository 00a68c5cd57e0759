# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The profile with what was found: it predicts what the model did."""

import json

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose.diagnosis import Estimate, Finding
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.nuisances import known_effects
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.diagnose.verdict.profile import mean_of_edge, updated_profile
from diagnose.planted import (
    BY_NAME,
    PLANTED,
    capture_of,
    frames_of,
    model_of,
    sensor_of,
)

OLD = {"r2": -0.2, "r4": 0.05, "r6": 0.0, "tilt_x": 0.01, "tilt_y": 0.0}
OLD |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
EFFECTS = {"lens_shading": OLD, "prnu": {"sigma": 0.01}}
SENSOR = sensor_of(effects=EFFECTS)


def finding(name, half=0.0, **values):
    """Return a finding of values, and of intervals that end half beside each."""
    estimates = {n: Estimate(x, "1", (x - half, x + half)) for n, x in values.items()}
    return Finding(name, estimates, 20.0, 1.0, [], [], "", "")


def updated(findings, edge=0.0):
    """Return (sensor, {effect: parameters}) of the profile with findings."""
    text = updated_profile(SENSOR, findings, [], edge=edge)
    effects = {e["name"]: e["parameters"] for e in json.loads(text)["effects"]}
    return Sensor.from_json(text, "found"), effects


@pytest.mark.parametrize(
    ("name", "values"),
    [*PLANTED.items(), ("shot_noise", (0.4,)), ("read_noise", (0.5,))],
)
def test_it_predicts_what_the_model_did(name, values):
    """Beside a fall-off of light and a PRNU that the profile had."""
    model = model_of(SENSOR, **{name: values})
    by_name = dict(zip(BY_NAME[name].parameters, values, strict=False))
    found, _ = updated([finding(name, **by_name)])
    captures = [capture_of("dark", 1), capture_of("scene", 2)]
    frames = zip(frames_of(SENSOR, captures), frames_of(found, captures), strict=True)
    for frame, again in frames:
        expected, written = predict(model, frame), predict(Model(found), again)
        np.testing.assert_allclose(written.mean, expected.mean, atol=1e-6)
        np.testing.assert_allclose(written.variance, expected.variance, rtol=1e-4)


def test_images_may_correct_values_by_their_errors():
    """An interval of 95 % ends 1.96 standard errors beside its middle."""
    found, _ = updated([finding("exposure", 0.0196, gain=0.1)])
    [(effect, errors)] = known_effects(found).items()
    assert effect.name == "exposure" and errors == pytest.approx([0.01], rel=1e-3)


def test_noise_that_is_drawn_otherwise():
    tails = finding("heavy_tailed_noise", fraction=0.02, variance_ratio=12.0)
    found, effects = updated([tails, finding("poisson_shot_noise", fraction=1.0)])
    assert effects.keys() == EFFECTS.keys()
    assert found.noise_effects == ["poisson_shot_noise", "heavy_tailed_noise"]
    [before], [row] = SENSOR.noise, found.noise
    assert (row["outlier_fraction"], row["outlier_variance_ratio"]) == (0.02, 12.0)
    assert (row["beta1"], row["beta2"]) == (before["beta1"], before["beta2"])


def test_values_are_beyond_the_profile_s_or_the_sensor_s_own():
    """A fall-off is that of light beyond what the profile has, a spread is measured
    whole. What was not found stays, and bounds are the registry's."""
    findings = [finding("lens_shading", r2=-0.1, r4=9.0), finding("prnu", sigma=0.02)]
    _, values = updated(findings)
    assert values["prnu"] == {"sigma": 0.02}
    shading = {name: values["lens_shading"][name] for name in OLD}
    assert shading == {**OLD, "r2": pytest.approx(-0.3), "r4": 8.0}


def test_a_black_level_is_beside_the_edge_of_the_first_columns():
    """The edge falls by e in 20 of 100 columns: the mean of all has 0.2037 of it."""
    levels = {f"offset_{site}": 0.01 for site in ("00", "01", "10", "11")}
    edge = finding("bias_structure", edge=0.02, edge_length=20.0)
    for some, expected in (([], 0.01), ([edge], 0.01 - 0.02 * 0.20366)):
        findings = [*some, finding("black_level", **levels)]
        _, values = updated(findings, mean_of_edge(findings, 100))
        assert values["black_level"]["offset_01"] == pytest.approx(expected, rel=1e-3)
