# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pictures of test frames: as bright as can be, residuals by their sign and size."""

import io

import numpy as np
import pytest
from PIL import Image

from cg2raw.diagnose.report import frame_images
from cg2raw.diagnose.report.frame_images import cells_of, frame, frames, rms, srgb
from cg2raw.diagnose.report.text import number
from diagnose.made_up_diagnosis import picture


def pixels(image):
    return np.asarray(Image.open(io.BytesIO(image.png)).convert("RGB"), float)


@pytest.fixture(scope="module")
def made():
    return picture("shot.dng", "scene", 40, 60, 3)


@pytest.mark.parametrize(
    ("linear", "code"), [(0, 0), (0.0031308, 10), (0.2140, 127), (1, 255), (2, 255)]
)
def test_display_is_srgb(linear, code):
    # IEC 61966-2-1; one code of rounding.
    assert abs(int(srgb(np.array([linear]))[0]) - code) <= 1


def test_a_frame_is_measured_before_and_after(made):
    caption, images = frame(made, 1)
    assert caption.startswith("shot.dng, scene: measured (times ")
    assert [(i.width, i.height) for i in images] == 3 * [(60, 40)]
    assert "before" in images[1].alt and "after" in images[2].alt


def test_red_is_brighter_than_predicted_and_grey_is_not_known(made):
    z = np.zeros((40, 60), np.float32)
    z[:10], z[10:20], z[20:30] = 4, -4, np.nan
    changed = type(made)(**{**vars(made), "z_before": z})
    shown = pixels(frame(changed, 1)[1][1])
    high, low, unknown, nothing = (shown[row, 0] for row in (5, 15, 25, 35))
    assert high[0] > 1.5 * high[2] and low[2] > 1.5 * low[0]
    assert (unknown == 128).all() and nothing.min() > 240


@pytest.mark.parametrize("side", [1, 2, 3, 4])
def test_a_reduced_map_of_noise_still_has_unit_deviation(side):
    z = np.random.default_rng(1).standard_normal((240, 251))
    z[:50, :60] = np.nan
    reduced = cells_of(z, side, side)
    assert reduced.shape == (240 // side, 251 // side)
    # The deviation of n normal draws is known to 1 / sqrt(2 n); five of these.
    whole = reduced[60 // side + 1 :]
    assert whole.std() == pytest.approx(1, abs=5 / np.sqrt(2 * whole.size))
    assert np.isnan(reduced[0, 0])


def test_many_frames_are_reduced_until_they_fit(monkeypatch):
    monkeypatch.setattr(frame_images, "BUDGET", 30_000)
    made = frames([picture("a.dng", "scene", 90, 120, n) for n in range(3)])
    images = [image for _, some in made for image in some]
    assert sum(len(image.png) for image in images) <= 30_000
    assert {image.width for image in images} <= {60, 40, 30}
    assert frames([]) == []


@pytest.mark.parametrize(("z", "words"), [([3.0, -4.0, np.nan], "3.5"), ([np.nan], "")])
def test_the_root_mean_square_of_a_map_is_that_of_what_is_known(z, words):
    assert rms(np.array(z)) == (words or number(None))
