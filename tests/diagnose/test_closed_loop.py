# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A found profile, simulated by oiiotool and diagnosed by itself, leaves no gap."""

import numpy as np
import pytest

from images import attributes, read_dn, write_image

pytest.importorskip("scipy")

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from diagnose.closed_loop import by_registry, scene_of, simulated

pytestmark = pytest.mark.slow

HIDDEN = [
    {"lens_shading": 0.3, "row_noise": 0.3},
    {"noise_reduction": 0.1},
    {"prnu": 0.01, "poisson_shot_noise": None},
    {"full_well": 0.05, "hot_pixels": None},
    {"heavy_tailed_noise": None, "black_level": None},
    {"blur": 0.6, "veiling_glare": 0.02},
    {"mains_flicker": None, "read_noise_correlation": None},
]


@pytest.fixture
def by_plugin(system_oiiotool, tmp_path):
    """Return (sensor, capture, number) -> DN, as the plugin writes them."""

    def simulate(sensor, capture, number):
        # Frames are read side by side.
        profile = tmp_path / f"{number}.json"
        profile.write_text(sensor.to_json())
        exr, dng = tmp_path / f"{number}.exr", tmp_path / f"{number}.dng"
        write_image(
            exr, scene_of(capture), {"ExposureTime": float(capture.exposure_time)}
        )
        system_oiiotool(
            exr,
            *attributes(
                sensor=profile,
                illuminant=capture.illuminant,
                convention="sensor",
                iso=capture.iso,
                frame=number,
            ),
            "-o",
            dng,
        )
        return read_dn(dng)

    return simulate


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda h: "+".join(h))
def test_frames_of_the_found_profile_have_no_gap(by_plugin, hidden):
    sensor = drawn_sensor(7)
    truth = draw_hidden(sensor, hidden, seed=7)
    captures = simulate_captures(sensor, truth, seed=7, twice=True)
    found = diagnose(captures, details=False)
    assert {one.name for one in found.effects} >= set(hidden) - {"poisson_shot_noise"}
    better = Sensor.from_json(found.profile_json)
    again = diagnose(simulated(captures, better, by_plugin), details=False)
    assert again.verdict == "consistent"
    assert again.gap.chi2_after == pytest.approx(1, abs=0.02)


def test_the_plugin_draws_what_python_draws(by_plugin):
    sensor = drawn_sensor(3)
    capture = simulate_captures(sensor, {}, seed=3).captures[6]
    written = by_plugin(sensor, capture, 5)
    assert np.array_equal(written, by_registry(sensor, capture, 5))
