# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects of what is there without light: each against its formula."""

import numpy as np
import pytest
from scipy import stats

from core import predicted as of
from core.predicted import SHOT, deviates, drawn

RAMPS = {"horizontal": 0.02, "vertical": -0.01, "edge": 0.03, "edge_length": 7.0}


def test_bias_structure_is_ramps_and_an_edge_that_fades():
    seen, mean, variance = drawn(0.2, [("bias_structure", RAMPS)], 50, 80)
    across, down = (np.arange(n) + 0.5 for n in (80, 50))
    expected = 0.02 * (across / 80 - 0.5) + 0.03 * np.exp(-np.arange(80) / 7.0)
    expected = expected - 0.01 * (down / 50 - 0.5)[:, None]
    np.testing.assert_allclose(seen - np.float32(0.2), expected, atol=1e-7)
    np.testing.assert_array_equal(seen, mean)
    assert not variance.any()
    white, _, _ = drawn(1.0, [("bias_structure", RAMPS)], 50, 80)
    assert (white == 1.0).all(), "it falls on the read-out, behind the clipping"


STEPS = {
    "horizontal_offset": 0.02,
    "vertical_offset": -0.01,
    "horizontal_response": 0.2,
    "vertical_response": -0.4,
}
READ = {f"beta2_{site}": 1e-4 for site in ("00", "01", "10", "11")}


@pytest.mark.parametrize("height, width", [(150, 180), (151, 183)])
def test_amplifier_mismatch_is_a_step_in_the_middle(height, width):
    """Amplifiers act on light with its noise, and not on what is read beside them."""
    settings = [
        *[("shot_noise", SHOT), ("amplifier_mismatch", STEPS), ("read_noise", READ)]
    ]
    seen, mean, variance = drawn(0.2, settings, height, width)
    right = np.where(np.arange(width) < width // 2, -0.5, 0.5)
    below = np.where(np.arange(height) < height // 2, -0.5, 0.5)[:, None]
    factor = 1 + 0.2 * right - 0.4 * below
    np.testing.assert_allclose(
        mean, 0.2 * factor + 0.02 * right - 0.01 * below, atol=1e-7
    )
    np.testing.assert_allclose(variance, 4e-4 * factor**2 + 1e-4, rtol=1e-5)
    normal = (seen - mean) / np.sqrt(variance)
    parts = [half for one in np.split(normal, [height // 2]) for half in
             np.split(one, [width // 2], axis=1)]  # fmt: skip
    for part in parts:
        of_mean, of_variance = deviates(part.size)
        assert part.mean() == pytest.approx(0, abs=of_mean)
        assert part.var() == pytest.approx(1, abs=of_variance)


def test_black_level_drift_is_one_normal_number_per_frame():
    settings = [("black_level_drift", {"sigma": 0.01})]
    offsets = []
    for frame in range(400):
        seen, _, variance = drawn(0.2, settings, 6, 8, frame=frame)
        assert np.ptp(seen) == 0.0
        assert variance == pytest.approx(1e-4, rel=1e-5)
        offsets.append((float(seen[0, 0]) - np.float32(0.2)) / 0.01)
    of_mean, of_variance = deviates(len(offsets))
    assert np.mean(offsets) == pytest.approx(0, abs=of_mean)
    assert np.var(offsets) == pytest.approx(1, abs=of_variance)
    assert stats.kstest(offsets, "norm").pvalue > 1e-4


def uneven(seconds, **given):
    """What dark current that differs from pixel to pixel adds, in float64."""
    setting = {"rate": 0.01, "log_sigma": 0.8, **given}
    settings = ("dark_current_nonuniformity", setting)
    return of.predicted(of.flat(0.0, 400, 600), settings, exposure_time=seconds)[0]


def test_dark_current_nonuniformity_is_log_normal_about_its_median():
    charge = uneven(2.0).astype(float)
    normal = np.log1p(charge / 0.02) / 0.8
    of_mean, of_variance = deviates(normal.size)
    assert normal.mean() == pytest.approx(0, abs=of_mean)
    assert normal.var() == pytest.approx(1, abs=of_variance)
    assert stats.kstest(normal.ravel()[::7], "norm").pvalue > 1e-4
    np.testing.assert_allclose(uneven(6.0), 3 * charge, rtol=1e-5, atol=1e-8)
    np.testing.assert_allclose(uneven(2.0, rate=0.02), 2 * charge, rtol=1e-5, atol=1e-8)
    assert not uneven(0.0).any()


def test_dark_current_nonuniformity_has_the_shot_noise_of_its_charge():
    settings = [
        ("dark_current_nonuniformity", {"rate": 0.01, "log_sigma": 0.8}),
        ("dark_current", {"per_second": 0.01}),
        ("shot_noise", SHOT),
    ]
    mean, variance = of.predicted(of.flat(0.0), *settings, exposure_time=2.0)
    assert mean.min() > 0, "no charge is below 0 where dark_current is as large"
    np.testing.assert_allclose(variance, 2e-3 * mean, rtol=1e-5)


GLOW = {"per_second": 0.03, "row": -1.0, "column": 0.5, "extent": 0.2}


@pytest.mark.parametrize("size", [(40, 60), (61, 41)])
def test_amplifier_glow_fades_from_its_place_as_time_goes(size):
    rows, cols = size
    half = np.hypot(rows, cols) / 2
    down = np.arange(rows)[:, None] + 0.5
    across = np.arange(cols)[None] + 0.5 - (1 + 0.5) * cols / 2
    far = np.hypot(down, across) / half
    for seconds in (0.0, 2.0):
        mean, variance = of.predicted(
            of.flat(0.1, rows, cols),
            ("amplifier_glow", GLOW),
            ("shot_noise", SHOT),
            exposure_time=seconds,
        )
        expected = 0.1 + seconds * 0.03 * np.exp(-far / 0.2)
        np.testing.assert_allclose(mean, expected, rtol=2e-6)
        np.testing.assert_allclose(variance, 2e-3 * expected, rtol=1e-5)
