# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A real chart whose file says a wrong black level, white balance and matrix."""

import shutil

import numpy as np
import pytest

from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.chart import ColorChecker
from cg2raw.diagnose.captures.reader import read_captures, read_frames
from cg2raw.diagnose.frames.frame import camera_of

CANON = "real/canon550d_colorchart_tinydng.dng"
GREYS = range(18, 23)  # patches white to neutral 3.5; black has too little light
PIXELS = 32768  # of the frame, as the page has it


def neutral_of_greys(captures, frame, black):
    """Return camera R/G and B/G of the light: those of the grey patches, weighted by
    their light, over what the patches' published colours add.

    black : (2, 2) DN of the sites of the CFA, RGGB."""
    capture, entry = frame.capture, frame.entry
    raw = capture.raw().astype(float)
    chart = ColorChecker(entry.corners, capture.shape, 1.0)
    patch, _ = chart.positions(slice(0, capture.shape[0]))
    chosen = capture.mask() & np.isin(patch, list(GREYS))
    light = np.zeros((2, 2))
    for row, col in np.ndindex(2, 2):
        for grey in GREYS:
            here = (chosen & (patch == grey))[row::2, col::2]
            light[row, col] += raw[row::2, col::2][here].mean() - black[row, col]
    green = (light[0, 1] + light[1, 0]) / 2
    matrix = np.asarray(camera_of(captures, capture)[0], float)
    own = (chart.colors[list(GREYS)] @ matrix.T / matrix.sum(1)).sum(0)
    return light[0, 0] / green * own[1] / own[0], light[1, 1] / green * own[1] / own[2]


def optical_black(frame):
    """Return (2, 2) DN of the sites of the CFA: medians would be of whole DN."""
    left = next(border for border in frame.borders if "left" in border.name).raw()
    kept = np.where(np.abs(left - np.median(left)) < 100.0, left, np.nan)  # hot ones
    return np.array([[np.nanmean(kept[r::2, c::2]) for c in (0, 1)] for r in (0, 1)])


@pytest.mark.slow
@pytest.mark.parametrize("pixels", [PIXELS, 2 * PIXELS])
def test_what_the_tags_say_wrong_is_found(camera_data, repository, tmp_path, pixels):
    """README of the camera data: black 2049 against the tag's 2056, grey row R/G 0.63
    to 0.70 against AsShotNeutral 0.404, ColorMatrix1[0] 0.646 against 0.694."""
    shutil.copy(camera_data / CANON, tmp_path)
    yaml = repository / "tests" / "data" / "canon550d_captures.yaml"
    path = shutil.copy(yaml, tmp_path / "captures.yaml")
    captures = read_captures(path)
    [frame] = read_frames(path)[2]
    found = diagnose(captures, pixels=pixels, details=False)
    by_name = {finding.name: finding.parameters for finding in found.effects}
    assert {"white_balance", "black_level", "color_matrix"} <= set(by_name)
    assert "gr_gb_imbalance" not in by_name  # what greens share is a white balance
    sensor = captures.sensor
    told = np.reshape(sensor.black_level, (2, 2))
    assert (told == 2056).all() and sensor.cfa == "RGGB"
    shifts = [
        [by_name["black_level"][f"offset_{r}{c}"].value for c in (0, 1)] for r in (0, 1)
    ]
    black = told + np.array(shifts) * (sensor.white_level - told)
    border = optical_black(frame)
    print("black", black, "border", border)
    np.testing.assert_allclose(black, border, atol=0.5)
    assert border.mean() == pytest.approx(2049, abs=0.5)
    balance = by_name["white_balance"]
    as_shot = frame.capture.as_shot
    neutral = [
        as_shot[0] / as_shot[1] * (1 + balance["red"].value),
        as_shot[2] / as_shot[1] * (1 + balance["blue"].value),
    ]
    measured = neutral_of_greys(captures, frame, border)
    print("neutral", neutral, "greys", measured)
    assert neutral[0] == pytest.approx(measured[0], rel=0.02)
    # B/G differs by 2.4 % among the greys.
    error = np.ptp(balance["blue"].ci95) / 2 * as_shot[2] / as_shot[1]
    assert error < 0.015
    assert neutral[1] == pytest.approx(measured[1], abs=0.024 * measured[1] + error)
    assert found.gap.after < 0.5 * found.gap.before
