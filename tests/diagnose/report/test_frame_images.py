# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The report's pictures: one exposure for a frame, residual maps to scale."""

import io

import numpy as np
import pytest
from PIL import Image

from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.report import frame_images as frames
from diagnose.made_up_diagnosis import picture


def pixels(image):
    """Return an image's (h, w, 3) codes."""
    return np.asarray(Image.open(io.BytesIO(image.png)).convert("RGB")).astype(int)


def flat(level, size=(8, 8)):
    """Return a uniform signal."""
    return np.full((*size, 3), level, np.float32)


def plain_picture(measured, before, after, z=None, neutral=(1.0, 1.0, 1.0)):
    """Return a Picture; its residuals are @z, or zero."""
    z = np.zeros(measured.shape[:2], np.float32) if z is None else z
    return Picture("a.dng", "scene", measured, before, after, z, z, neutral)


def test_the_three_pictures_have_one_exposure():
    shown = frames.frame(plain_picture(flat(0.45), flat(0.225), flat(0.45)), 1, 1)
    codes = [pixels(image)[0, 0].tolist() for image in shown.images]
    # 0.9 and 0.45 of the display, as IEC 61966-2-1 encodes them.
    assert codes == [[243] * 3, [179] * 3, [243] * 3]
    assert shown.gain == pytest.approx(2)


def test_a_neutral_is_shown_grey():
    tinted = flat(1.0) * np.float32([0.3, 0.6, 0.4])
    shown = frames.frame(
        plain_picture(tinted, tinted, tinted, neutral=(0.5, 1, 2 / 3)), 1, 1
    )
    assert np.ptp(pixels(shown.images[0])) <= 1


@pytest.mark.parametrize("neutral", [None, (0.0, 1.0, 1.0), (np.nan, 1, 1)])
def test_a_dark_is_shown_dark(neutral):
    dark = flat(1e-4)
    shown = frames.frame(plain_picture(dark, dark, dark, neutral=neutral), 1, 1)
    assert shown.gain == frames.LARGEST_GAIN and pixels(shown.images[0]).max() < 30


def test_residuals_are_red_above_white_at_zero_blue_below_grey_if_masked():
    z = np.array([[0, 4, -4, 9, -9, np.nan, 2, -2]], np.float32)
    index, palette = frames.map_colors(z)
    colors = np.array(list(palette)).reshape(-1, 3)[index[0]]
    zero, high, low, beyond, below, masked, some_high, some_low = colors.tolist()
    assert min(zero) > 240 and masked == list(frames.MASKED)
    assert high == beyond and low == below
    assert high[0] > 2 * high[2] and low[2] > 2 * low[0]
    assert some_high[0] > some_high[2] and some_low[2] > some_low[0]


@pytest.mark.parametrize("side", [1, 2, 3, 4])
def test_a_reduced_map_of_noise_still_has_unit_deviation(side):
    z = np.random.default_rng(1).standard_normal((240, 251))
    z[:50, :60] = np.nan
    reduced = frames.reduced_sum(z, side)
    count = np.isfinite(reduced).sum()
    assert reduced.shape == (-(-240 // side), -(-251 // side))
    # The deviation of n normal draws is known to 1 / sqrt(2 n); five of these.
    assert np.nanstd(reduced) == pytest.approx(1, abs=5 / np.sqrt(2 * count))
    assert np.isnan(reduced[0, 0])


def test_a_reduced_picture_keeps_its_means():
    signal = np.random.default_rng(2).uniform(0, 1, (12, 18, 3))
    reduced = frames.reduced_mean(signal, 3)
    assert reduced.shape == (4, 6, 3)
    assert reduced.mean(axis=(0, 1)) == pytest.approx(signal.mean(axis=(0, 1)))


def test_many_frames_are_reduced_until_they_fit(monkeypatch):
    monkeypatch.setattr(frames, "BUDGET", 30_000)
    made = frames.frames([picture("a.dng", "scene", 90, 120, n) for n in range(3)])
    images = [image for f in made for image in (*f.images, *f.maps)]
    assert sum(len(image.png) for image in images) <= 30_000
    assert {image.width for image in images} <= {60, 40, 30}
    assert [image.name for image in made[1].images][0] == "frame_02_measured.png"


def test_no_pictures_no_frames():
    assert frames.frames([]) == []
