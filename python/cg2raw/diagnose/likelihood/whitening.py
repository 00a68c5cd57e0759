# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Flows: they turn structured noise into white noise, and say what that costs.

Each takes standardised residuals z (T, h, w) and returns new ones and the log of the
determinant per pixel, so that the density of a frame stays a density. A photon's
skewness: E. A. Cornish, R. A. Fisher, Rev. Inst. Int. Stat. 5(4), 1938.
"""

import numpy as np
from scipy import fft
from scipy.special import log_ndtr, ndtr, ndtri, owens_t

from cg2raw.diagnose.effects.catalogue import Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.prediction import Model, Prediction, flow_values

Whitened = tuple[Array, Array | float]

FAR = 7.0  # standard deviations beyond which a series is not trusted
LEAST_CHANCE = 1e-15
NEAR_WELL = 6.0  # standard deviations below the well that its clipping is felt in


def early_clipping(
    z: Array, p: Prediction, values: Values, frame: Frame, read_variance: Array
) -> Whitened:
    """The exact density of min(photons, well) + read noise near the well, and the
    normal score of what was measured."""
    well = 1 - values[0]
    light = np.broadcast_to(p.light_variance, z.shape)
    below = (well - p.exposed) / np.sqrt(p.photon_variance + light + 1e-14)
    near = below < NEAR_WELL
    extra = np.zeros_like(z)
    if values[0] <= 0 or not near.any():
        return z, extra
    x, s2, light = p.exposed[near], p.photon_variance[near] + 1e-14, light[near]
    mean, clipped = _clipped_photons(x, s2, well)
    known = p.variance[near] - light
    least = 0.2 * np.broadcast_to(read_variance, z.shape)[near]
    rest = np.maximum(known - clipped, least)
    y = z[near] * np.sqrt(p.variance[near]) + mean  # before the read-out's offsets
    s2 = s2 + light  # light that nobody measured is clipped too
    sd, a, both = np.sqrt(s2), below[near], s2 + rest
    split = np.sqrt(s2 * rest / both)
    open_ = -0.5 * (y - x) ** 2 / both - 0.5 * np.log(both)
    open_ += log_ndtr((well - (x * rest + y * s2) / both) / split)
    shut = log_ndtr(-a) - 0.5 * (y - well) ** 2 / rest - 0.5 * np.log(rest)
    below_y = _both_below(a, (y - x) / np.sqrt(both), sd / np.sqrt(both))
    below_y += ndtr(-a) * ndtr((y - well) / np.sqrt(rest))
    white = z.copy()
    white[near] = ndtri(np.clip(below_y, LEAST_CHANCE, 1 - LEAST_CHANCE))
    extra[near] = (
        np.logaddexp(open_, shut)
        + 0.5 * white[near] ** 2
        + 0.5 * np.log(p.variance[near])
    )
    return white, extra


def _clipped_photons(x: Array, variance: Array, well: float) -> tuple[Array, Array]:
    """Return mean and variance of min(N(x, variance), well)."""
    sd = np.sqrt(variance)
    a = (well - x) / sd
    density = np.exp(-0.5 * np.minimum(a * a, 1400)) / np.sqrt(2 * np.pi)
    inside = ndtr(a)
    mean = x - sd * (density - a * (1 - inside))
    moment = variance * (inside - a * density) + (a * sd) ** 2 * (1 - inside)
    return mean, np.maximum(moment - (mean - x) ** 2, 0)


def _both_below(h: Array, k: Array, correlation: Array) -> Array:
    """Return the chance that two standard normal numbers lie below h and k.

    Source: D. B. Owen, Ann. Math. Stat. 27(4), 1956."""
    h, k = (np.where(np.abs(v) < 1e-9, 1e-9, v) for v in (h, k))
    root = np.sqrt(1 - correlation**2)
    unlike = np.where(h * k < 0, 0.5, 0.0)
    of_h = owens_t(h, (k / h - correlation) / root)
    of_k = owens_t(k, (h / k - correlation) / root)
    return np.asarray(0.5 * (ndtr(h) + ndtr(k)) - of_h - of_k - unlike)


def row_noise(
    z: Array, p: Prediction, values: Values, frame: Frame, power: float = -0.5
) -> Whitened:
    """Shrinks each row's common offset: a covariance of rank one a row.

    power : of the covariance that z is multiplied by; -0.5 whitens."""
    share = (values[0] ** 2 * frame.beta2.mean()) / p.variance * frame.keep
    total = frame.tiles.over_rows(share) + 1e-300
    eigenvalue = 1 + total
    direction = np.sqrt(share / total)
    along = direction * frame.tiles.over_rows(direction * z)
    white = z - (1 - eigenvalue**power) * along
    count = np.maximum(frame.tiles.over_rows(frame.keep.astype(float)), 1)
    return white, power * np.log(eigenvalue) / count * frame.keep


def photon_statistics(
    z: Array, p: Prediction, values: Values, frame: Frame
) -> Whitened:
    """Poisson's third and fourth cumulants, by the Cornish-Fisher series."""
    photons = np.maximum(p.exposed, 1e-12)
    third = values[0] * p.photon_variance**2 / photons
    fourth = third * p.photon_variance / photons
    skew = np.minimum(third / p.variance**1.5, 0.35)
    excess = np.minimum(fourth / p.variance**2, 0.12)
    c = np.clip(z, -FAR, FAR)
    square = c * c
    white = c - skew / 6 * (square - 1) - excess / 24 * (square - 3) * c
    white += skew**2 / 36 * (4 * square - 7) * c
    slope = 1 - skew / 3 * c - excess / 24 * (3 * square - 3)
    slope += skew**2 / 36 * (12 * square - 7)
    near = np.abs(z) < FAR
    cost = np.where(near, np.log(np.maximum(slope, 0.05)), 0.0)
    return np.where(near, white, z), cost


def heavy_tailed_noise(
    z: Array, p: Prediction, values: Values, frame: Frame, read_variance: Array
) -> Whitened:
    """A share of the read noise is wider than the rest, the variance as it was."""
    fraction, ratio = values
    read = np.minimum(read_variance / p.variance, 1)
    core = read / (1 + fraction * (ratio - 1))
    wide, narrow = 1 - read + ratio * core, 1 - read + core
    log_wide = np.log(fraction) - 0.5 * z * z / wide - 0.5 * np.log(wide)
    log_narrow = np.log1p(-fraction) - 0.5 * z * z / narrow - 0.5 * np.log(narrow)
    tail = fraction * ndtr(-np.abs(z) / np.sqrt(wide))
    tail += (1 - fraction) * ndtr(-np.abs(z) / np.sqrt(narrow))
    white = -np.sign(z) * ndtri(np.maximum(tail, 1e-300))
    return white, np.logaddexp(log_wide, log_narrow) + 0.5 * white**2


def noise_reduction(z: Array, values: Values) -> Whitened:
    """Divides by the filter that a camera blended its noise with, in frequency."""
    blend, diagonal = values
    centre = 1 - blend - diagonal
    height, width = z.shape[-2:]
    cy = np.cos(4 * np.pi * np.fft.fftfreq(height))[:, None]
    cx = np.cos(4 * np.pi * np.fft.rfftfreq(width))[None]
    filter_ = centre + blend / 2 * (cy + cx) + diagonal * cy * cx
    power = filter_**2 / (centre**2 + blend**2 / 4 + diagonal**2 / 4) + 1e-4
    log_sum = 2 * np.log(power).sum() - np.log(power[:, 0]).sum()
    if width % 2 == 0:
        log_sum -= np.log(power[:, -1]).sum()
    white = fft.irfft2(fft.rfft2(z) / np.sqrt(power), z.shape[-2:])
    return white, -0.5 * log_sum / (height * width)


def whiten(
    z: Array, p: Prediction, model: Model, frame: Frame
) -> tuple[Array, Array | float]:
    """Apply the flows of a model in order; return residuals and summed costs."""
    excess = model.term("read_noise")
    read = frame.beta2 * np.exp(excess.values[0] if excess else 0.0)
    cost: Array | float = 0.0
    for name in ORDER:
        if name == "nuisance":
            if model.nuisance is None:
                continue
            z, more = model.nuisance.whiten(z, p, frame)
            cost = cost + more
            continue
        values = flow_values(model, frame, name)
        if values is None:
            continue
        if name == "noise_reduction":
            z, more = noise_reduction(z, values)
        elif name == "row_noise":
            if frame.is_cut:  # then they are part of the prediction: cut_rows
                continue
            z, more = row_noise(z, p, values, frame)
        elif name == "photon_statistics":
            z, more = photon_statistics(z, p, values, frame)
        elif name == "heavy_tailed_noise":
            z, more = heavy_tailed_noise(z, p, values, frame, read)
        else:
            z, more = early_clipping(z, p, values, frame, read)
        cost = cost + more
    return z, cost


ORDER = (
    "early_clipping",
    "noise_reduction",
    "row_noise",
    "nuisance",
    "photon_statistics",
    "heavy_tailed_noise",
)
