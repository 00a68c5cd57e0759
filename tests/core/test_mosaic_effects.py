# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects of pixels, response, read-out and output: each against its formula."""

import numpy as np
import pytest
from scipy import integrate, stats

from core import predicted as of
from core.predicted import SHOT, deviates, drawn

BAYER = ("RGGB", "GRBG", "GBRG", "BGGR")
READ = {f"beta2_{site}": 1e-4 for site in ("00", "01", "10", "11")}


def ideal(camera, cfa="RGGB"):
    return of.predicted(camera, cfa=cfa)[0]


def shifted(image, row, col, margin=2):
    """A mosaic read elsewhere, continued by its mirror image."""
    height, width = image.shape
    padded = np.pad(image, margin, "reflect")
    return padded[margin + row :, margin + col :][:height, :width]


def test_crosstalk_takes_from_its_neighbours():
    parts = {"left": 0.05, "right": 0.03, "up": 0.02, "down": 0.01}
    image = of.noise_image()
    before, (seen, _) = ideal(image), of.predicted(image, ("crosstalk", parts))
    expected = 0.89 * before
    for part, at in zip(
        parts.values(), [(0, -1), (0, 1), (-1, 0), (1, 0)], strict=True
    ):
        expected += part * shifted(before, *at)
    np.testing.assert_allclose(seen, expected, rtol=1e-6)


def test_crosstalk_of_an_impulse():
    """The pixel to the right of a bright one takes part of it from its left."""
    image = of.flat(0.0)
    image[:, 10, 20] = 1.0
    parts = {"left": 0.05, "right": 0.03, "up": 0.02, "down": 0.01}
    seen, _ = of.predicted(image, ("crosstalk", parts))
    around = np.array([[0, 0.01, 0], [0.03, 0.89, 0.05], [0, 0.02, 0]])
    np.testing.assert_allclose(seen[9:12, 19:22], around, atol=1e-7)
    assert seen.sum() == pytest.approx(1.0)


@pytest.mark.parametrize("cfa", BAYER)
def test_gr_is_green_in_rows_of_red(cfa):
    image = of.noise_image()
    given = {"gr": 0.02, "gb": -0.03}
    ratio = of.predicted(image, ("gr_gb_imbalance", given), cfa=cfa)[0] / ideal(
        image, cfa
    )
    for site, color in enumerate(cfa):
        row = cfa[site // 2 * 2 :][:2]
        factor = {"R": 1.0, "B": 1.0, "G": 1.02 if "R" in row else 0.97}[color]
        np.testing.assert_allclose(ratio[site // 2 :: 2, site % 2 :: 2], factor, 1e-6)


def test_prnu_is_a_normal_factor_per_pixel_of_the_sensor():
    shape = (3, 300, 400)
    maps = []
    for level, sensor in ((0.2, "a"), (0.8, "a"), (0.8, "b")):
        image = np.full(shape, level, np.float32)
        seen, _ = of.predicted(
            image, ("prnu", {"sigma": 0.02}), of=of.sensor(id=sensor)
        )
        maps.append((seen / level - 1) / 0.02)
    np.testing.assert_allclose(maps[0], maps[1], atol=2e-5)
    assert abs(np.corrcoef(maps[1].ravel(), maps[2].ravel())[0, 1]) < 0.015
    assert stats.kstest(maps[0].ravel(), "norm").pvalue > 1e-4
    mean, variance = deviates(maps[0].size)
    assert maps[0].mean() == pytest.approx(0, abs=mean)
    assert maps[0].var() == pytest.approx(1, abs=variance)


def test_dark_current_is_light_that_time_makes():
    """Hence its shot noise."""
    settings = (("dark_current", {"per_second": 0.02}), ("shot_noise", SHOT))
    for seconds in (0.0, 0.5, 4.0):
        mean, variance = of.predicted(of.flat(0.1), *settings, exposure_time=seconds)
        np.testing.assert_allclose(mean, 0.1 + 0.02 * seconds, rtol=1e-6)
        np.testing.assert_allclose(variance, 2e-3 * mean, rtol=1e-6)


def test_nonlinearity_is_its_polynomial_and_a_line_beyond():
    levels = np.linspace(-0.2, 1.8, 64)
    image = np.broadcast_to(levels, (3, 4, 64))
    seen, _ = of.predicted(image, ("nonlinearity", {"quadratic": 0.1, "cubic": -0.04}))
    u = np.clip(levels, 0, 1.3)
    expected = levels - 0.1 * u**2 + 0.04 * u**3
    np.testing.assert_allclose(seen, np.broadcast_to(expected, (4, 64)), atol=2e-7)


def clipped_moments(mean, variance, level):
    """Mean and variance of min(X, level) for a normal X, by quadrature."""
    normal = stats.norm(mean, np.sqrt(variance))
    least = mean - 12 * np.sqrt(variance)

    def below(power):
        area, _ = integrate.quad(
            lambda x: (x - level) ** power * normal.pdf(x),
            least,
            level,
            points=[min(mean, level)],
            epsabs=0,
            epsrel=1e-11,
            limit=300,
        )
        return area

    first, second = below(1), below(2)
    return level + first, second - first**2


@pytest.mark.parametrize("sigmas", [-9, -5, -2, -0.5, 0.0, 0.7, 2.5, 5])
def test_full_well_has_the_moments_of_a_clipped_normal(sigmas):
    """With the mean this far above the level."""
    level, beta1 = 0.8, 2e-3
    mean = np.float32(level + sigmas * np.sqrt(beta1 * level))
    settings = (("shot_noise", SHOT), ("full_well", {"below_white": 1 - level}))
    seen, variance = of.predicted(of.flat(mean, 4, 4), *settings)
    expected = clipped_moments(float(mean), beta1 * float(mean), level)
    np.testing.assert_allclose(seen, expected[0], atol=1.2e-7)
    np.testing.assert_allclose(variance, expected[1], rtol=2e-5, atol=1e-12)


def test_full_well_of_what_has_no_noise():
    levels = np.array([0.3, 0.7, 0.75, 0.8, 2.0], np.float32)
    image = np.broadcast_to(levels, (3, 2, 5))
    mean, variance = of.predicted(image, ("full_well", {"below_white": 0.25}))
    np.testing.assert_array_equal(mean, np.minimum(np.stack([levels] * 2), 0.75))
    assert not variance.any()


@pytest.mark.parametrize("level", [0.74, 0.8, 0.83])
def test_full_well_draws_what_it_predicts(level):
    """Before the read-out, whose noise goes beyond the level."""
    settings = [("shot_noise", SHOT), ("full_well", {"below_white": 0.2})]
    seen, mean, variance = drawn(level, settings)
    assert seen.max() == pytest.approx(0.8) and (seen == seen.max()).mean() > 0.05
    of_mean, of_variance = deviates(seen.size, 8)  # the tails are not normal
    assert seen.mean() == pytest.approx(
        mean.mean(), abs=of_mean * np.sqrt(variance.mean())
    )
    assert seen.var() == pytest.approx(variance.mean(), rel=of_variance)
    seen, mean, variance = drawn(level, [*settings, ("read_noise", READ)])
    assert seen.max() > 0.82
    assert seen.var() == pytest.approx(variance.mean(), rel=of_variance)


def test_black_level_moves_each_site_but_for_white():
    offsets = {"offset_00": 0.01, "offset_01": -0.02, "offset_10": 0.03}
    for level, part in ((0.2, 1.0), (1.0, 0.0)):
        seen, mean, variance = drawn(level, [("black_level", offsets)], 12, 18)
        for site, offset in enumerate((0.01, -0.02, 0.03, 0.0)):
            piece = seen[site // 2 :: 2, site % 2 :: 2]
            np.testing.assert_allclose(piece, level + part * offset, atol=1e-7)
        np.testing.assert_array_equal(seen, mean)
        assert not variance.any()


@pytest.mark.parametrize("name", ["column_fixed_pattern", "dsnu"])
def test_fixed_offsets_do_not_depend_on_signal_or_frame(name):
    settings = [(name, {"sigma": 0.01})]
    rows, cols = (40, 6000) if name == "column_fixed_pattern" else (300, 400)
    low, mean, _ = drawn(0.2, settings, rows, cols)
    high, _, _ = drawn(0.7, settings, rows, cols, frame=4, seed=8)
    np.testing.assert_array_equal(low, mean)
    offset = (low - np.float32(0.2)) / 0.01
    np.testing.assert_allclose((high - np.float32(0.7)) / 0.01, offset, atol=2e-5)
    if name == "column_fixed_pattern":
        np.testing.assert_array_equal(offset, np.broadcast_to(offset[0], offset.shape))
        offset = offset[0]
    of_mean, of_variance = deviates(offset.size)
    assert offset.mean() == pytest.approx(0, abs=of_mean)
    assert offset.var() == pytest.approx(1, abs=of_variance)
    assert stats.kstest(offset.ravel(), "norm").pvalue > 1e-4


def hot(seconds, **given):
    """Offsets that hot pixels add to the dark, in float64."""
    setting = ("hot_pixels", {"fraction": 0.01, "rate": 0.05, **given})
    return of.predicted(of.flat(0.0, 600, 800), setting, exposure_time=seconds)[0]


def test_hot_pixels_are_few_and_gather_charge_exponentially():
    offset = hot(2.0)
    pixels = offset[offset > 0]
    expected = 0.01 * offset.size
    assert pixels.size == pytest.approx(expected, abs=5 * np.sqrt(expected))
    assert stats.kstest(pixels / 0.1, "expon").pvalue > 1e-4
    assert offset.sum() == pytest.approx(0.1 * expected, rel=8 / np.sqrt(expected))
    np.testing.assert_allclose(hot(6.0), 3 * offset, rtol=1e-6)
    np.testing.assert_allclose(hot(2.0, rate=0.1), 2 * offset, rtol=1e-6)
    assert not hot(0.0).any()


def test_more_hot_pixels_are_those_and_others():
    few, more = hot(2.0), hot(2.0, fraction=0.02)
    assert (more[few > 0] > few[few > 0]).all()
    assert (more > 0).sum() > 1.8 * (few > 0).sum()


NR = {"blend": 0.3, "diagonal": 0.1}
BESIDE = [(-2, 0), (2, 0), (0, -2), (0, 2)]
ACROSS = [(-2, -2), (-2, 2), (2, -2), (2, 2)]


def blended(image, own, beside, across):
    result = own * image
    for weight, places in ((beside, BESIDE), (across, ACROSS)):
        for at in places:
            result += weight * shifted(image, *at)
    return result


@pytest.mark.parametrize("cfa", BAYER)
def test_noise_reduction_blends_pixels_of_a_colour(cfa):
    image = of.noise_image()
    before, variance = of.predicted(image, ("shot_noise", SHOT), cfa=cfa)
    settings = (("shot_noise", SHOT), ("noise_reduction", NR))
    seen, left = of.predicted(image, *settings, cfa=cfa)
    np.testing.assert_allclose(seen, blended(before, 0.6, 0.075, 0.025), rtol=1e-6)
    expected = blended(variance, 0.6**2, 0.075**2, 0.025**2)
    np.testing.assert_allclose(left, expected, rtol=1e-6)


def test_noise_reduction_sees_highlights_as_white():
    image = of.flat(0.5)
    image[:, 20, 30] = 40.0
    seen, _ = of.predicted(image, ("noise_reduction", NR))
    assert seen[20, 30] == pytest.approx(0.6 + 0.4 * 0.5)
    np.testing.assert_allclose(seen[20, [28, 32]], 0.5 + 0.075 * 0.5, rtol=1e-6)
    np.testing.assert_allclose(seen[18, [28, 32]], 0.5 + 0.025 * 0.5, rtol=1e-6)


def test_noise_reduction_correlates_noise_of_a_colour():
    seen, mean, variance = drawn(0.4, [("read_noise", READ), ("noise_reduction", NR)])
    kernel = np.zeros((5, 5))
    kernel[2, 2] = 0.6
    kernel[[0, 4, 2, 2], [2, 2, 0, 4]] = 0.075
    kernel[[0, 0, 4, 4], [0, 4, 0, 4]] = 0.025
    noise = (seen - mean)[4:-4, 4:-4]  # the mirror doubles neighbours at the edges
    bound = 5 * 1e-4 / np.sqrt(noise.size)

    def covariance(row, col):
        height, width = noise.shape
        return (noise[row:, col:] * noise[: height - row, : width - col]).mean()

    assert covariance(0, 0) == pytest.approx(variance[4:-4, 4:-4].mean(), abs=2 * bound)
    for row, col in ((0, 1), (1, 1), (0, 2), (2, 0), (2, 2), (0, 4), (2, 4)):
        overlap = kernel[row:, col:] * kernel[: 5 - row, : 5 - col]
        assert covariance(row, col) == pytest.approx(1e-4 * overlap.sum(), abs=bound)
    assert covariance(0, 2) > 10 * bound
