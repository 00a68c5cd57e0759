# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Whitening: densities stay densities, structured noise becomes white."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import multivariate_normal, norm, poisson

from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.likelihood.whitening import whiten
from diagnose.planted import BY_NAME, capture_of, frames_of, model_of, sensor_of

SHAPE = (1, 24, 20)


@pytest.fixture(scope="module")
def frame():
    (made,) = frames_of(sensor_of(), [capture_of("flat", shape=SHAPE[1:])])
    return replace(made, keep=np.ones(SHAPE, bool), beta2=made.beta2)


def prediction(mean=0.3, variance=1e-4, photon_variance=None):
    """Return a prediction that is the same at all pixels."""
    photons = variance if photon_variance is None else photon_variance
    full = (np.full(SHAPE, float(x)) for x in (mean, variance, mean, photons))
    return Prediction(*full)


def whitened(name, z, p, values, frame=None, read=None):
    """Return (residuals, log of the determinant) as an effect whitens them."""
    read = frame.beta2 if read is None and frame else read
    return BY_NAME[name].whiten(z, p, values, frame, read)


def numerical_slope(white, z, step=1e-5):
    return (white(z + step) - white(z - step)) / (2 * step)


def one_pixel(frame):
    """Return (points, frame) so that every pixel of a tile is one point of z."""
    z = np.linspace(-6, 6, SHAPE[1] * SHAPE[2]).reshape(SHAPE)
    return z, frame


@pytest.mark.parametrize("fraction", [0.3, 1.0])
def test_poisson_shot_noise_cost_is_the_log_of_its_slope(frame, fraction):
    z, frame = one_pixel(frame)
    p = prediction(mean=0.02, variance=frame.beta1.mean() * 0.02 + frame.beta2.mean())

    def white(at):
        return whitened("poisson_shot_noise", at, p, np.array([fraction]), frame)[0]

    cost = whitened("poisson_shot_noise", z, p, np.array([fraction]), frame)[1]
    inner = np.abs(z) < 4
    assert np.exp(cost)[inner] == pytest.approx(numerical_slope(white, z)[inner], 1e-3)


def test_heavy_tails_cost_is_the_log_of_its_slope(frame):
    z, frame = one_pixel(frame)
    p = prediction(0.0, 1.3 * frame.beta2.mean())
    values = np.array([0.03, 9.0])

    def white(at):
        return whitened("heavy_tailed_noise", at, p, values, frame)[0]

    cost = whitened("heavy_tailed_noise", z, p, values, frame)[1]
    assert np.exp(cost) == pytest.approx(numerical_slope(white, z), 1e-3)


def test_heavy_tails_are_the_mixture_of_two_normals(frame):
    """A share f of the read noise has r times the variance of the rest."""
    z = np.linspace(-16, 16, SHAPE[1] * SHAPE[2]).reshape(SHAPE)
    share, f, r = 0.7, 0.04, 16.0
    p = prediction(0.1, frame.beta2.mean() / share)
    white, cost = whitened("heavy_tailed_noise", z, p, np.array([f, r]), frame)
    core = share / (1 + f * (r - 1))
    expected = f * norm.pdf(z, scale=np.sqrt(1 - share + r * core))
    expected += (1 - f) * norm.pdf(z, scale=np.sqrt(1 - share + core))
    assert np.exp(cost) * norm.pdf(white) == pytest.approx(expected, rel=1e-9)
    step = z.ravel()[1] - z.ravel()[0]
    moments = [(expected.ravel() * z.ravel() ** n).sum() * step for n in (0, 2)]
    assert moments == pytest.approx([1, 1], abs=0.01)


@pytest.mark.parametrize("electrons", [15, 30, 100])
def test_poisson_shot_noise_near_the_convolution_of_poisson_and_normal(electrons):
    """Expected log density, of photons that are counted, within 2e-4 nats of the
    convolution's own, and far nearer than a normal."""
    full_well, read = 5000.0, 3.0
    sensor = sensor_of(full_well, read)
    (frame,) = frames_of(sensor, [capture_of("flat", shape=SHAPE[1:])])
    variance = electrons + read**2
    y = np.linspace(electrons - 6 * variance**0.5, electrons + 6.5 * variance**0.5, 480)
    counts = np.arange(0, 6 * electrons + 60)
    true = norm.pdf(y[:, None], counts, read) @ poisson.pmf(counts, electrons)
    z = ((y - electrons) / variance**0.5).reshape(SHAPE)
    x = electrons / full_well
    p = prediction(x, variance / full_well**2, x / full_well)
    white, cost = whitened("poisson_shot_noise", z, p, np.array([1.0]), frame)
    flow = np.exp(cost).ravel() * norm.pdf(white.ravel()) / variance**0.5
    step = y[1] - y[0]
    assert flow.sum() * step == pytest.approx(1, abs=2e-3)
    lost = (true * np.log(true / flow)).sum() * step
    normal = (true * np.log(true / norm.pdf(y, electrons, variance**0.5))).sum() * step
    assert lost < 2e-4 if electrons >= 30 else 2e-3
    assert lost < 0.2 * normal


def test_photons_of_another_gain_are_lopsided_by_it(frame):
    """beta1 twice as large is half the electrons, hence sqrt(2) times the skewness."""
    z = np.where(np.arange(SHAPE[2]) % 2, 2.0, -2.0) * np.ones(SHAPE)
    moved = []
    for gain in (1.0, 2.0):
        photons = gain * frame.beta1.mean() * 0.05
        p = prediction(0.05, photons, photons)
        white, _ = whitened("poisson_shot_noise", z, p, np.array([1.0]), frame)
        moved.append(-white.mean())
    assert moved[1] / moved[0] == pytest.approx(2**0.5, rel=0.05)


def test_row_noise_is_the_dense_normal(frame):
    rng = np.random.default_rng(1)
    sigma, beta2 = 0.4, frame.beta2.mean()
    keep = rng.random(SHAPE) < 0.8
    masked = replace(frame, keep=keep)
    variance = beta2 * (1 + rng.random(SHAPE))
    p = replace(prediction(), variance=variance)
    z = rng.standard_normal(SHAPE)
    white, cost = whitened("row_noise", z, p, np.array([sigma]), masked)
    density = (-0.5 * white**2 - 0.5 * np.log(2 * np.pi) + cost)[keep].sum()
    expected = 0.0
    for row in range(SHAPE[1]):
        chosen = keep[0, row]
        bearing = np.sqrt(sigma**2 * beta2 / variance[0, row, chosen])
        covariance = np.eye(chosen.sum()) + np.outer(bearing, bearing)
        expected += multivariate_normal(cov=covariance).logpdf(z[0, row, chosen])
    assert density == pytest.approx(expected, abs=1e-8)


def test_row_noise_becomes_white(frame):
    rng = np.random.default_rng(2)
    sigma, beta2 = 1.0, frame.beta2.mean()
    p = prediction(0.0, beta2)
    rows = sigma * rng.standard_normal((400, 24, 1))
    z = rows + rng.standard_normal((400, 24, 20))
    below = np.stack([24 * np.arange(400), np.zeros(400)], 1).astype(np.int32)
    tiles = replace(frame.tiles, origins=below)
    many = replace(frame, keep=np.ones(z.shape, bool), tiles=tiles)
    p = Prediction(
        *(
            np.broadcast_to(np.mean(x), z.shape)
            for x in (p.mean, p.variance, p.exposed, p.photon_variance)
        )
    )
    white, _ = whitened("row_noise", z, p, np.array([sigma]), many)
    assert z.mean(-1).var() > 1
    assert white.mean(-1).var() * 20 == pytest.approx(1, abs=0.05)
    assert white.var() == pytest.approx(1, abs=0.01)


def test_tiles_beside_each_other_share_their_rows(frame):
    rng = np.random.default_rng(3)
    beta2 = frame.beta2.mean()
    rows = rng.standard_normal((1, 400, 1))
    z = rows + rng.standard_normal((2, 400, 20))
    tiles = replace(frame.tiles, origins=np.array([[0, 0], [0, 20]], np.int32))
    pair = replace(frame, keep=np.ones(z.shape, bool), tiles=tiles)
    p = Prediction(*(np.full(z.shape, x) for x in (0.0, beta2, 0.0, 0.0)))
    white, _ = whitened("row_noise", z, p, np.array([1.0]), pair)
    left, right = white.mean(-1)
    assert abs(np.corrcoef(left, right)[0, 1]) < 0.15
    together, _ = whitened(
        "row_noise",
        z.swapaxes(0, 1).reshape(1, 400, 40),
        Prediction(*(np.full((1, 400, 40), x) for x in (0.0, beta2, 0.0, 0.0))),
        np.array([1.0]),
        replace(frame, keep=np.ones((1, 400, 40), bool)),
    )
    both = white.swapaxes(0, 1).reshape(1, 400, 40)
    np.testing.assert_allclose(both, together, atol=1e-12)


def clipping_density(
    frame, mean, below_white, read, signal, light=0.0, tails=(0.0, 1.0)
):
    """Return the density of signals (n,) at a mean, per unit of signal, and their
    residuals. light : variance of light that nobody measured. tails : of read noise."""
    photons = frame.beta1.mean() * mean
    well = 1 - below_white
    a = (well - mean) / photons**0.5
    inside, peak = norm.cdf(a), norm.pdf(a)
    first = mean - photons**0.5 * (peak - a * (1 - inside))
    second = photons * (inside - a * peak) + (a * photons**0.5) ** 2 * (1 - inside)
    variance = max(second - (first - mean) ** 2, 0) + read + light
    known = (np.full(SHAPE, x) for x in (first, variance, mean, photons, light))
    p = Prediction(*known)
    z = ((signal - first) / variance**0.5).reshape(SHAPE)
    values = np.array([below_white])
    p = replace(p, tails=tails)
    white, extra = whitened("full_well", z, p, values, frame, np.full(SHAPE[1:], read))
    density = np.exp(extra + norm.logpdf(white) - 0.5 * np.log(variance))
    return density.ravel(), white.ravel()


@pytest.mark.parametrize("light", [0.0, 0.03])
@pytest.mark.parametrize("mean", [0.72, 0.79, 0.80, 0.81, 0.86])
def test_full_well_is_the_density_of_clipped_photons_and_read_noise(frame, mean, light):
    """min(photons, well) + read noise: it integrates to 1, and its histogram is that
    of draws."""
    read, well = frame.beta2.mean(), 0.8
    wide = 8 * np.sqrt(frame.beta1.mean() * mean + read + light**2)
    y = np.linspace(min(mean, well) - wide, well + 8 * np.sqrt(read), 480)
    density, white = clipping_density(frame, mean, 1 - well, read, y, light**2)
    step = y[1] - y[0]
    assert density.sum() * step == pytest.approx(1, abs=0.003)
    rng = np.random.default_rng(5)
    spread = np.sqrt(frame.beta1.mean() * mean + light**2)
    photons = mean + spread * rng.standard_normal(400_000)
    draws = np.minimum(photons, well) + np.sqrt(read) * rng.standard_normal(400_000)
    below = np.searchsorted(np.sort(draws), y) / len(draws)
    assert norm.cdf(white) == pytest.approx(below, abs=0.004)
    assert np.cumsum(density) * step - density * step / 2 == pytest.approx(
        below,
        abs=0.02,  # of a peak that is two steps wide
    )


@pytest.mark.parametrize("mean", [0.79, 0.86])
def test_a_full_pixel_has_the_tails_of_read_noise(frame, mean):
    """A twentieth of it is four times as wide: an integral of 1, and draws as far from
    the well as they are."""
    read, well, share, ratio = frame.beta2.mean(), 0.8, 0.05, 16.0
    photons = frame.beta1.mean() * mean
    low = min(mean, well) - 8 * np.sqrt(photons + read)
    y = np.linspace(low, well + 40 * np.sqrt(read), 480)
    density, white = clipping_density(frame, mean, 1 - well, read, y, 0, (share, ratio))
    assert density.sum() * (y[1] - y[0]) == pytest.approx(1, abs=0.01)
    rng = np.random.default_rng(6)
    core = read / (1 + share * (ratio - 1))
    wide = np.where(rng.random(400_000) < share, ratio, 1) * core
    charge = mean + np.sqrt(photons) * rng.standard_normal(wide.size)
    draws = np.minimum(charge, well) + np.sqrt(wide) * rng.standard_normal(wide.size)
    below = np.searchsorted(np.sort(draws), y) / wide.size
    assert norm.cdf(white) == pytest.approx(below, abs=0.004)
    far = y > well + 5 * np.sqrt(read)
    assert norm.sf(white[far]) == pytest.approx(1 - below[far], abs=1e-4)
    assert (1 - below[far]).max() > 3e-4


def test_tails_are_not_counted_twice_near_the_well(frame):
    well = Well(0.8, np.full(SHAPE, 0.7), np.full(SHAPE, 1e-4))
    well.charge[:, :, ::2] = 0.9
    p = replace(prediction(0.8), well=well)
    z = np.full(SHAPE, 5.0)
    white, cost = whitened("heavy_tailed_noise", z, p, np.array([0.05, 16.0]), frame)
    assert (white[:, :, ::2] == 5).all() and not cost[:, :, ::2].any()
    assert (white[:, :, 1::2] < 5).all()


def test_full_well_far_below_the_well_is_the_normal(frame):
    y = np.linspace(0.2, 0.4, 480)
    density, _ = clipping_density(frame, 0.3, 0.2, frame.beta2.mean(), y)
    variance = frame.beta1.mean() * 0.3 + frame.beta2.mean()
    assert density == pytest.approx(norm.pdf(y, 0.3, variance**0.5), rel=1e-6)


def test_a_density_of_photons_integrates_to_one(frame):
    p = prediction(0.006, frame.beta1.mean() * 0.006 + frame.beta2.mean())

    def density(z):
        white, cost = whitened(
            "poisson_shot_noise", np.full(SHAPE, z), p, np.array([1.0]), frame
        )
        return float((np.exp(cost) * norm.pdf(white))[0, 0, 0])

    assert quad(density, -6.9, 6.9, limit=200)[0] == pytest.approx(1, abs=0.003)


@pytest.mark.parametrize("name", ["row_noise", "black_level_drift"])
def test_what_pixels_share_is_blended_too(frame, name):
    """Noise and an offset of as many standard deviations, blended by a camera: what is
    left is white, as it is without noise reduction."""
    blend, diagonal, sigma, read = 0.33, 0.02, 0.6, np.sqrt(frame.beta2.mean())
    rng = np.random.default_rng(4)
    shared = (1, SHAPE[1], 1) if name == "row_noise" else (1, 1, 1)
    model = model_of(sensor_of(), noise_reduction=[blend, diagonal], **{name: [sigma]})
    cos = [np.cos(4 * np.pi * np.fft.fftfreq(n)) for n in SHAPE[1:]]
    cy, cx = cos[0][:, None], cos[1][None]
    response = 1 - blend - diagonal + blend / 2 * (cy + cx) + diagonal * cy * cx
    left = (1 - blend - diagonal) ** 2 + blend**2 / 4 + diagonal**2 / 4
    p = prediction(mean=0.0, variance=left * read**2, photon_variance=0.0)
    squares = []
    for _ in range(400):
        noise = rng.standard_normal(SHAPE) + sigma * rng.standard_normal(shared)
        shown = np.fft.ifft2(np.fft.fft2(noise) * response).real
        white = whiten(shown / np.sqrt(left), p, model, frame)[0]
        squares.append(np.mean(white, axis=(1, 2) if shared[1] == 1 else 2) ** 2)
    pixels = SHAPE[1] * SHAPE[2] if shared[1] == 1 else SHAPE[2]
    assert np.mean(squares) * pixels == pytest.approx(1, rel=0.15)
