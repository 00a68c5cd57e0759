# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The true log density of a frame, in nats per pixel; its unit of level is 1 DN."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.special import log_ndtr, logsumexp

from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.memory import told_by_before
from cg2raw.synthetic.photons import ROUNDING, normal, photon_density
from cg2raw.synthetic.readout import (
    Noise,
    blend_response,
    blended,
    row_unit,
)

LOWEST = -1e4  # nats; what cannot have happened
ROW_NODES = 11


def log_density(
    dn: NDArray[np.uint16],
    charge: Plane,
    pedestal: Plane,
    noise: Noise,
    camera: Camera,
    unsure: Plane | float = 0.0,
) -> NDArray[np.float32]:
    """Return (H, W) log densities of a frame under the model that drew it.

    charge, pedestal : expected, electrons and DN. unsure : variance, DN^2, of the
    expectation, where patterns are known from other frames only.

    The probability of the rounded value, of all beyond where it clipped. A row's offset
    is integrated out and its density shared by the row's pixels; noise reduction is
    undone first and its determinant counted, with the rounding that came after it. A
    frame's offset likewise."""
    level = dn.astype(np.float64)
    low, high = dn == 0, dn >= camera.white
    if noise.blend:
        level, more = _before_blend(level, noise.blend)
        margin = 3 * np.sqrt(more)
        low, high = level < margin, level > camera.white - margin
        unsure = unsure + more - ROUNDING

    def at_offset(offset: Plane | float) -> Plane:
        moved = pedestal + offset
        if noise.correlation:
            known = np.where(low | high, np.nan, level)
            shift, less = _by_memory(known, charge, moved, noise, camera, unsure)
            return _independent(
                level, low, high, charge, moved + shift, noise, camera, unsure - less
            )
        return _independent(level, low, high, charge, moved, noise, camera, unsure)

    unit = row_unit(camera)

    def of_rows(offset: Plane | float) -> Plane:
        return _mean(lambda more: at_offset(offset + more), noise.row * unit, 1)

    density = _mean(of_rows, noise.frame * unit, None)
    if noise.blend:
        density = density - _log_determinant(level.shape, noise.blend)
    return np.maximum(density, LOWEST).astype(np.float32)


def _before_blend(level: Plane, blend: float) -> tuple[Plane, float]:
    """Undo noise reduction; return also the variance that rounding has become."""
    response = blend_response((level.shape[0] // 2, level.shape[1] // 2), blend)
    return blended(level, blend, inverse=True), ROUNDING * float(np.mean(response**-2))


def _by_memory(
    level: Plane,
    charge: Plane,
    pedestal: Plane,
    noise: Noise,
    camera: Camera,
    unsure: Plane | float,
) -> tuple[Plane, Plane]:
    """Return (mean, variance that is not left) of levels, DN and DN^2, given those
    before them in the row; noise as if it were Gaussian."""
    gain = camera.over(camera.dn_per_electron, level.shape)
    read = gain * camera.over(camera.read_noise, level.shape)
    read = read * np.sqrt(np.dot(noise.weights, noise.variances))
    variance = gain**2 * noise.excess * charge + read**2 + unsure + ROUNDING
    shared = np.zeros_like(read)
    shared[:, 1:] = noise.correlation * read[:, 1:] * read[:, :-1]
    return told_by_before(level - pedestal - gain * charge, variance, shared)


def _log_determinant(shape: tuple[int, int], blend: float) -> Plane:
    """Return each pixel's share of the filter's log determinant."""
    share = np.empty(shape)
    for row in range(2):
        for col in range(2):
            sites = share[row::2, col::2]
            sites[:] = np.log(np.abs(blend_response(sites.shape, blend))).mean()
    return share


def _mean(
    at_offset: Callable[[Plane | float], Plane], half: float, axis: int | None
) -> Plane:
    """Integrate over a uniform offset of each row (axis 1) or of the frame (None): its
    likelihood is smooth, so a few nodes carry a spline that is summed finely. Pixels
    have their density at the mean offset; what is less sure is shared by the pixels."""
    if not half:
        return at_offset(0.0)
    nodes = half * np.cos(np.pi * (np.arange(ROW_NODES) + 0.5) / ROW_NODES)[::-1]
    planes = [at_offset(node) for node in nodes]
    groups = np.stack([np.atleast_1d(plane.sum(axis)) for plane in planes])
    fine = np.linspace(-half, half, 2001)
    sums: Plane = CubicSpline(nodes, groups, axis=0)(fine)
    weights = np.full(len(fine), 1.0 / (len(fine) - 1))
    weights[[0, -1]] /= 2
    total: Plane = logsumexp(sums, axis=0, b=weights[:, None])
    odds = np.exp(sums - sums.max(0)) * weights[:, None]
    mean = (fine @ odds / odds.sum(0))[:, None]
    there = at_offset(mean)
    alike = there.size // len(total)
    shared: Plane = (total - np.atleast_1d(there.sum(axis)))[:, None] / alike
    return there + shared


def _independent(
    level: Plane,
    low: NDArray[np.bool_],
    high: NDArray[np.bool_],
    charge: Plane,
    pedestal: Plane,
    noise: Noise,
    camera: Camera,
    unsure: Plane | float,
) -> Plane:
    """Log density of pixels that know nothing of each other."""
    shape = level.shape
    gain = camera.over(camera.dn_per_electron, shape)
    read = (gain * camera.over(camera.read_noise, shape)) ** 2  # DN^2
    parts = []
    for weight, ratio in zip(noise.weights, noise.variances, strict=True):
        around = ratio * read + unsure
        if np.isfinite(noise.well):
            well = pedestal + gain * noise.well * camera.over(camera.full_well, shape)
            one = _clipped(level, charge, pedestal, gain, around, well, noise.excess)
        else:
            well = np.inf
            variance = gain**2 * noise.excess * charge + around
            one = _rounded(level, pedestal + gain * charge, np.sqrt(variance))
        if noise.poisson:  # near a well, many photons: they are Gaussian there
            room = gain * 6 * np.sqrt(noise.excess * charge + 1)
            inner = ~low & ~high & (pedestal + gain * charge + room < well)
            one = np.where(
                inner,
                photon_density(level, charge, pedestal, gain, around, noise.excess),
                one,
            )
        ends = _ends(charge, pedestal, gain, around, noise, camera)
        one = np.where(low, ends[0], np.where(high, ends[1], one))
        parts.append(np.log(weight) + one)
    mixed: Plane = logsumexp(parts, axis=0)
    return mixed


def _rounded(level: Plane, mean: Plane, sd: Plane) -> Plane:
    """Log probability that a Gaussian rounds to a level."""
    a, b = (level - 0.5 - mean) / sd, (level + 0.5 - mean) / sd
    a, b = np.where(a > 0, -b, a), np.where(a > 0, -a, b)  # the accurate tail
    upper, lower = log_ndtr(b), log_ndtr(a)
    rounded: Plane = upper + np.log1p(-np.exp(np.minimum(lower - upper, -1e-300)))
    return rounded


def _ends(
    charge: Plane,
    pedestal: Plane,
    gain: Plane,
    around: Plane,
    noise: Noise,
    camera: Camera,
) -> tuple[Plane, Plane]:
    """Log probabilities of 0 DN and of white; the charge as a Gaussian."""
    mean = pedestal + gain * charge
    if np.isfinite(noise.well):
        full = camera.over(camera.full_well, charge.shape)
        mean = np.minimum(mean, pedestal + gain * noise.well * full)
    sd = np.sqrt(gain**2 * noise.excess * charge + around)
    return log_ndtr((0.5 - mean) / sd), log_ndtr((mean - camera.white + 0.5) / sd)


def _clipped(
    level: Plane,
    charge: Plane,
    pedestal: Plane,
    gain: Plane,
    around: Plane,
    well: Plane,
    excess: float,
) -> Plane:
    """Log density where charge stops at the full well and is read with noise.

    Either the charge was below the well, or the well was read."""
    mean = pedestal + gain * charge
    shot = gain**2 * excess * charge + 1e-12
    around = around + ROUNDING
    total = shot + around
    middle = (mean * around + level * shot) / total
    spread = np.sqrt(shot * around / total)
    below = normal(level - mean, total) + log_ndtr((well - middle) / spread)
    at_well = log_ndtr((mean - well) / np.sqrt(shot)) + normal(level - well, around)
    either: Plane = np.logaddexp(below, at_well)
    return either
