# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that the registry's simulation draws, alone: found with their values, and no
gap where the profile lists them. All by name:
tests/diagnose/test_darks_and_flats.py."""

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from diagnose.closed_loop import simulated
from diagnose.planted import READ, sensor_of, shot_by_registry
from tiers import slow

SENSOR = sensor_of()
# Of white, of the order of the read noise of a pixel.
BIAS = {"horizontal": -READ, "vertical": 0.5 * READ}
BIAS |= {"edge": 1.5 * READ, "edge_length": 12.0}
GLOW = {"per_second": READ, "row": -1.0, "column": 0.6, "extent": 0.25}
# How wide an interval may be. The grid of PDAF pixels is found once, and exact.
WIDEST = {
    "pdaf_pixels": {"gain": 0.01, "pitch": 0, "row": 0, "column": 0},
    "read_noise_correlation": {"coefficient": 0.04},
    "mains_flicker": {"amplitude": 0.02, "period": 8.0},
    "bias_structure": dict.fromkeys(BIAS, 0.5 * READ) | {"edge_length": 12.0},
    "amplifier_glow": dict.fromkeys(GLOW, 0.2),
    "black_level_drift": {"sigma": 1.5 * READ},
}


@pytest.mark.parametrize(
    ("name", "values", "seed"),
    [
        ("mains_flicker", {"amplitude": 0.02, "period": 37.0}, 1),
        slow("mains_flicker", {"amplitude": 0.005, "period": 60.0}, 2),
        slow("pdaf_pixels", {"gain": -0.1, "pitch": 12, "row": 5, "column": 3}, 1),
        slow("pdaf_pixels", {"gain": 0.02, "pitch": 9, "row": 0, "column": 8}, 2),
        slow("read_noise_correlation", {"coefficient": -0.07}, 1),
        slow("read_noise_correlation", {"coefficient": 0.25}, 2),
        slow("bias_structure", BIAS, 1),
        slow("amplifier_glow", GLOW, 1),
        slow("black_level_drift", {"sigma": 0.2 * READ}, 2),
    ],
)
def test_it_is_found_with_its_values(name, values, seed):
    captures = shot_by_registry(SENSOR, {name: values}, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    [one] = found.effects
    assert one.name == name
    [entry] = Sensor.from_json(found.profile_json, "found").effects
    for parameter, widest in WIDEST[name].items():
        low, high = one.parameters[parameter].ci95
        assert low <= values[parameter] <= high <= low + widest, parameter
        assert low <= entry["parameters"][parameter] <= high


@pytest.mark.slow
@pytest.mark.parametrize(
    "hidden",
    [
        {"lens_shading": 0.3, "row_noise": 0.3},
        {"noise_reduction": 0.1},
        {"prnu": 0.01, "poisson_shot_noise": None},
        {"full_well": 0.05, "hot_pixels": None},
        {"heavy_tailed_noise": None, "black_level": None},
        {"blur": 0.6, "veiling_glare": 0.02},
        {"mains_flicker": None, "read_noise_correlation": None},
    ],
    ids="+".join,
)
def test_frames_of_the_found_profile_have_no_gap(hidden):
    """What the generator hides, simulated by the profile that has what was found."""
    sensor = drawn_sensor(7)
    truth = draw_hidden(sensor, hidden, seed=7)
    captures = simulate_captures(sensor, truth, seed=7, twice=True)
    found = diagnose(captures, details=False)
    assert {one.name for one in found.effects} >= set(hidden) - {"poisson_shot_noise"}
    better = Sensor.from_json(found.profile_json)
    again = diagnose(simulated(captures, better), details=False)
    assert again.verdict == "consistent"
    assert again.gap.chi2_after == pytest.approx(1, abs=0.02)
