# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that the registry's simulation draws, alone: found with their values. All by
name: tests/diagnose/test_darks_and_flats.py; no gap where the profile lists them:
tests/diagnose/test_closed_loop.py."""

import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from diagnose.planted import READ, sensor_of, shot_by_registry
from tiers import slow

SENSOR = sensor_of()
# Of white, of the order of the read noise of a pixel.
BIAS = {"horizontal": -READ, "vertical": 0.5 * READ}
BIAS |= {"edge": 1.5 * READ, "edge_length": 12.0}
STEPS = {"horizontal_offset": READ, "vertical_offset": -READ}
STEPS |= {"horizontal_response": 0.02, "vertical_response": -0.01}
GLOW = {"per_second": READ, "row": -1.0, "column": 0.6, "extent": 0.25}
# How wide an interval may be. The grid of PDAF pixels is found once, and exact.
WIDEST = {
    "pdaf_pixels": {"gain": 0.01, "pitch": 0, "row": 0, "column": 0},
    "read_noise_correlation": {"coefficient": 0.04},
    "mains_flicker": {"amplitude": 0.02, "period": 8.0},
    "bias_structure": dict.fromkeys(BIAS, 0.5 * READ) | {"edge_length": 12.0},
    "amplifier_mismatch": {
        **dict.fromkeys(("horizontal_offset", "vertical_offset"), 0.4 * READ),
        **dict.fromkeys(("horizontal_response", "vertical_response"), 0.02),
    },
    "amplifier_glow": dict.fromkeys(GLOW, 0.2),
    "black_level_drift": {"sigma": READ},
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
        ("amplifier_mismatch", STEPS, 1),
        slow("amplifier_glow", GLOW, 1),
        slow("black_level_drift", {"sigma": 0.2 * READ}, 1),
        slow("black_level_drift", {"sigma": 0.4 * READ}, 3),
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
