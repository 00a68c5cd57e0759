# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects of light: each against its formula, on planted frames."""

import numpy as np
import pytest
from scipy import ndimage

from core import predicted as of

TIGHT = {"rtol": 3e-6, "atol": 3e-7}  # float32


def test_exposure_is_a_factor():
    image = of.noise_image()
    np.testing.assert_allclose(
        of.planes(image, "exposure", gain=0.3), 1.3 * image, 1e-6
    )


def test_white_balance_leaves_green():
    image = of.noise_image()
    seen = of.planes(image, "white_balance", red=-0.2, blue=0.4)
    factors = np.array([0.8, 1.0, 1.4])[:, None, None]
    np.testing.assert_allclose(seen, factors * image, 1e-6)


def test_color_matrix_acts_on_balanced_light():
    given = {"rg": 0.1, "rb": -0.05, "gr": 0.03, "gb": 0.2, "br": -0.15, "bg": 0.07}
    off = np.array([[-0.05, 0.1, -0.05], [0.03, -0.23, 0.2], [-0.15, 0.07, 0.08]])
    white = np.diag(of.NEUTRAL)
    matrix = white @ (np.eye(3) + off) @ np.linalg.inv(white)
    image = of.noise_image()
    seen = of.planes(image, "color_matrix", **given)
    np.testing.assert_allclose(seen, np.einsum("ij,jhw->ihw", matrix, image), **TIGHT)
    grey = 0.4 * np.array(of.NEUTRAL)[:, None, None] * np.ones((3, 8, 8))
    np.testing.assert_allclose(of.planes(grey, "color_matrix", **given), grey, **TIGHT)


def cosine(rows, cols, height=41, width=57):
    """A plane wave that the mirror continues: half periods between outermost pixels."""
    down = np.cos(np.pi * rows * np.arange(height) / (height - 1))
    across = np.cos(np.pi * cols * np.arange(width) / (width - 1))
    return (
        down[:, None] * across,
        np.pi * rows / (height - 1),
        np.pi * cols / (width - 1),
    )


@pytest.mark.parametrize("rows, cols", [(0, 0), (0, 9), (7, 0), (5, 11), (40, 56)])
def test_blur_scales_waves_by_its_otf(rows, cols):
    rings = {"ring_1": 0.21, "ring_2": -0.1, "ring_5": 0.04, "ring_10": 0.02}
    wave, down, across = cosine(rows, cols)
    image = np.broadcast_to(0.5 + 0.3 * wave, (3, *wave.shape))
    seen = of.planes(image, "blur", **rings, red_scale=0.5, blue_scale=-0.4)
    # McClellan's: the frequency whose cosine stands for that of the wave's two.
    x, y = np.cos(across), np.cos(down)
    radial = np.arccos(np.clip((-1 + x + y + x * y) / 2, -1, 1))
    for plane, scale in enumerate((1.5, 1.0, 0.6)):
        departure = sum(
            ring * (np.cos(int(name[5:]) * radial) - 1) for name, ring in rings.items()
        )
        expected = 0.5 + 0.3 * (1 + scale * departure) * wave
        np.testing.assert_allclose(seen[plane], expected, atol=2e-6)


def test_blur_is_radial_at_low_frequencies():
    """Along the diagonal as along rows, within 4 % of the ring up to pi / 2."""
    image = np.zeros((3, 101, 101), np.float32)
    image[:, 50, 50] = 1.0
    spread = of.planes(image, "blur", ring_2=0.2)[1]
    at = np.arange(101) - 50.0

    def otf(down, across):
        wave = np.cos(down * at)[:, None] * np.cos(across * at)
        wave -= np.sin(down * at)[:, None] * np.sin(across * at)
        return (spread * wave).sum()

    for w in (0.1, 0.4, 0.8, 1.2, 1.57):
        assert otf(0, w) == pytest.approx(1 + 0.2 * (np.cos(2 * w) - 1), abs=1e-5)
        assert otf(w / np.sqrt(2), w / np.sqrt(2)) == pytest.approx(
            otf(0, w), abs=0.04 * 0.2
        )


def test_color_shading_is_its_polynomial():
    image = of.noise_image(40, 61)
    given = {"red_r2": -0.3, "red_r4": 0.1, "red_x": 0.04, "red_y": -0.02}
    given |= {"blue_r2": 0.2, "blue_r4": -0.05, "blue_x": -0.03, "blue_y": 0.06}
    u, v = of.field(40, 61)
    square = u * u + v * v
    red = 1 - 0.3 * square + 0.1 * square**2 + 0.04 * u - 0.02 * v
    blue = 1 + 0.2 * square - 0.05 * square**2 - 0.03 * u + 0.06 * v
    expected = image * np.array([red, np.ones_like(red), blue])
    np.testing.assert_allclose(
        of.planes(image, "color_shading", **given), expected, 1e-6
    )


def smooth(y, x):
    """A pattern known between pixels."""
    return 0.5 + 0.2 * np.cos(0.31 * x + 0.17 * y) + 0.1 * np.sin(0.23 * y - 0.29 * x)


@pytest.mark.parametrize("shift, shift_r2", [(3.0, 0.0), (-1.3, 0.7), (0.02, -0.01)])
def test_lateral_chromatic_aberration_magnifies_by_px_at_the_corner(shift, shift_r2):
    """Also a hundredth of a pixel is what it says, to 1 %."""
    height, width = 121, 160
    half = np.hypot(height, width) / 2.0
    y = np.arange(height)[:, None] + 0.5 - height / 2.0
    x = np.arange(width)[None, :] + 0.5 - width / 2.0
    image = np.broadcast_to(smooth(y, x), (3, height, width))
    given = {"red": shift, "red_r2": shift_r2, "blue": -shift, "blue_r2": -shift_r2}
    seen = of.planes(image, "lateral_chromatic_aberration", **given)
    np.testing.assert_array_equal(seen[1], image[1].astype(np.float32))
    inner = (slice(12, -12), slice(12, -12))  # beyond, the mirror is not the pattern
    for plane, sign in ((0, 1.0), (2, -1.0)):
        by = sign * (shift + shift_r2 * (x * x + y * y) / half**2) / half
        moved = smooth(y * (1 + by), x * (1 + by)) - image[plane]
        left = (seen[plane] - image[plane] - moved)[inner]
        assert np.abs(left).max() < 0.012 * np.abs(moved).max()


@pytest.mark.parametrize("r2, r4", [(3.0, 0.0), (-1.3, 0.7), (8.0, 8.0), (0.02, -0.01)])
def test_lens_distortion_displaces_all_colours_by_px_at_the_corner(r2, r4):
    """Also a hundredth of a pixel is what it says, to 1.2 %."""
    height, width = 121, 160
    u, v = of.field(height, width)
    half, square = np.hypot(height, width) / 2.0, u * u + v * v
    scales = np.array([0.8, 1.0, 0.6])[:, None, None]
    image = scales * smooth(half * v, half * u)
    seen = of.planes(image, "lens_distortion", r2=r2, r4=r4)
    by = 1 + (r2 * square + r4 * square**2) / half
    moved = scales * smooth(half * v * by, half * u * by) - image
    left = (seen - image - moved)[:, 20:-20, 20:-20]  # beyond, the mirror is seen
    assert np.abs(left).max() < 0.012 * np.abs(moved).max()


@pytest.mark.parametrize(
    "name, values",
    [
        ("lateral_chromatic_aberration", {"red": 4, "blue_r2": -4}),
        ("lens_distortion", {"r2": 8, "r4": -5}),
    ],
)
def test_displacements_leave_what_is_flat(name, values):
    seen = of.planes(of.flat(0.37), name, **values)
    np.testing.assert_allclose(seen, 0.37, rtol=1e-6)


def test_veiling_glare_leaves_what_is_flat():
    seen = of.planes(of.flat(0.4), "veiling_glare", uniform=0.2, wide=0.1)
    np.testing.assert_allclose(seen, 0.4, rtol=2e-6)


def test_veiling_glare_lifts_by_the_mean_and_by_what_is_near():
    image = np.zeros((3, 240, 320), np.float32)
    image[:, :, 200:] = np.array([0.3, 0.6, 0.9])[:, None, None]
    seen = of.planes(image, "veiling_glare", uniform=0.1)
    mean = image.mean((1, 2), dtype=float)[:, None, None]
    np.testing.assert_allclose(seen, 0.9 * image + 0.1 * mean, rtol=1e-5)
    seen = of.planes(image, "veiling_glare", wide=0.1)
    wide = np.stack([ndimage.gaussian_filter(p.astype(float), 240 / 6) for p in image])
    np.testing.assert_allclose(seen, 0.9 * image + 0.1 * wide, atol=1e-3)


def test_mains_flicker_is_a_wave_down_the_rows_of_a_phase_per_frame():
    amplitude, period, height = 0.2, 12.5, 100
    plain = of.sensor()
    waved = of.sensor(
        settings=[("mains_flicker", {"amplitude": amplitude, "period": period})]
    )
    image = np.moveaxis(of.noise_image(height, 40), 0, -1).copy()
    run = {"illuminant": "D50", "camera_input": True}
    clean = np.asarray(plain.signal(image, **run), float)
    rows, phases = np.arange(height), []
    for frame in range(400):
        seen = np.asarray(waved.signal(image, **run, seed=1, frame=frame), float)
        factor = seen / clean
        assert np.ptp(factor, axis=1).max() < 1e-5, "all of a row alike"
        wave = (factor[:, 0] - 1) @ np.exp(-2j * np.pi * rows / period) * 2 / height
        assert np.abs(wave) == pytest.approx(amplitude, rel=1e-4)
        expected = 1 + amplitude * np.cos(2 * np.pi * rows / period + np.angle(wave))
        np.testing.assert_allclose(factor[:, 0], expected, atol=1e-5)
        phases.append(np.angle(wave))
    # The mean vector of 400 even phases is 0.05 long: three times that is chance 1e-4.
    for turns in (1, 2):
        assert np.abs(np.exp(1j * turns * np.array(phases)).mean()) < 0.15
    mean, variance = (np.asarray(x, float) for x in waved.predict(image, **run))
    np.testing.assert_allclose(mean, clean, **TIGHT)
    np.testing.assert_allclose(variance, (amplitude * clean) ** 2 / 2, rtol=1e-5)


@pytest.mark.parametrize("pitch, row, column", [(4, 0, 0), (9, 8, 3), (16, 21, 63)])
def test_pdaf_pixels_are_a_regular_grid(pitch, row, column):
    image = of.noise_image(50, 70)
    given = {"gain": -0.3, "pitch": pitch, "row": row, "column": column}
    plain, seen = of.predicted(image)[0], of.predicted(image, ("pdaf_pixels", given))[0]
    rows, columns = np.mgrid[:50, :70]
    own = (rows % pitch == row % pitch) & (columns % pitch == column % pitch)
    np.testing.assert_allclose(seen, np.where(own, 0.7, 1.0) * plain, rtol=1e-6)
    assert own.sum() > 5


def test_places_of_a_grid_are_whole_numbers():
    says = "pdaf_pixels: row 1.5 must be a whole number of 0 to 63 px"
    with pytest.raises(ValueError, match=says):
        of.predicted(of.noise_image(), ("pdaf_pixels", {"pitch": 8, "row": 1.5}))
