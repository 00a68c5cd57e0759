# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Light: response of pixels (PRNU), shading, linearity, and the lamp's drift.

Source: EMVA Standard 1288, release 4.0, sections on PRNU (after a high-pass) and
linearity; D. B. Goldman, IEEE Trans. PAMI 32(12), 2010 (the shading's polynomial)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from cg2raw.calibration.frames import Group
from cg2raw.calibration.measured import Measured, root_of
from cg2raw.calibration.photon_transfer import TransferPoints
from cg2raw.calibration.robust import CUT, MAD, Array, clipped_moments, profiles_of
from cg2raw.calibration.sites import FIELD_BLOCKS, Sites, blocks_of, centres

WINDOW = 15  # px of one site, across; wider structure is shading
SHADING = ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
LOWEST, HIGHEST = 0.05, 0.95  # of saturation, between which linearity is judged
FEWEST_LEVELS = 3


@dataclass(frozen=True)
class Light:
    """Response to uniform light.

    prnu : relative, standard deviation of pixels after a high-pass; total : before it,
    shading and dust included; mad : likewise by the median absolute deviation.
    shading : {coefficient: value}, of lens_shading. fall_off : relative, rms of that
    shading over the field. residual : relative, rms of what it leaves of the map.
    field : (blocks, blocks) relative response. level : DN above black. frames : how
    many flats are in it. noise : relative variance of a pixel by temporal noise.
    profiles : of halves of the frame, see profiles_of."""

    prnu: Measured
    total: float
    mad: float
    shading: dict[str, Measured]
    fall_off: Measured
    residual: float
    field: Array
    fine: NDArray[np.float32]
    level: float
    frames: int
    noise: float
    profiles: tuple[Array, Array]


@dataclass(frozen=True)
class Linearity:
    """Level against exposure time under one lamp.

    error : %, mean absolute deviation from the line with an offset, of the level (EMVA
    1288). quadratic, cubic : loss at white, of nonlinearity; cubic None where it does
    not stand out. bend : relative, mean absolute deviation from a line through zero,
    which these describe. exposures : s; levels : DN above black; deviations : %."""

    error: Measured
    quadratic: Measured
    cubic: Measured | None
    bend: float
    exposures: Array
    levels: Array
    deviations: Array


def light_of(
    mean: NDArray[np.float32],
    known: Array,
    sites: Sites,
    temporal: float,
    frames: int,
    fixed_variance: float = 0.0,
) -> Light:
    """Return the response of an (H, W) mean of flats, DN above black; it is altered.

    known : (H, W) bool. temporal : DN^2, noise of that mean in a pixel.
    fixed_variance : DN^2, of its pixels' own offsets where no dark took them off."""
    levels = []
    for plane, used in zip(sites.of(mean), sites.of(known), strict=True):
        level = float(np.median(plane[used]))
        plane /= np.float32(level)
        levels.append(level)
    level = float(np.mean(levels))
    noise = float(np.mean([(temporal + fixed_variance) / x**2 for x in levels]))
    flat = mean[known]
    mad = MAD * float(np.median(np.abs(flat - np.median(flat))))
    shading, field, fall_off, residual = field_of(mean, known, sites)
    noise *= float(np.mean(1 / np.maximum(field, 0.05)))  # darker corners are noisier
    variance, pixels, total = [], 0, float(np.std(flat, dtype=np.float64))
    fine = np.ones_like(mean)
    planes = zip(sites.of(mean), sites.of(known), sites.of(fine), strict=True)
    for plane, used, out in planes:
        out[:] = high_passed(plane, used)
        border = min(WINDOW // 2, *(side // 4 for side in plane.shape))
        inner = np.s_[border:-border, border:-border]  # whose windows are whole
        _, sigma, count = clipped_moments(out[inner][used[inner]])
        variance.append(sigma**2)
        pixels += count
    measured = float(np.mean(variance)) / (1 - 1 / WINDOW**2)
    error = math.sqrt(2 / pixels) * math.hypot(measured, noise)
    prnu = root_of(measured - noise, error, "1")
    mean[~known] = 1
    return Light(
        prnu,
        total,
        mad,
        shading,
        fall_off,
        residual,
        field,
        fine,
        level,
        frames,
        noise,
        profiles_of(mean),
    )


def high_passed(plane: Array, known: Array) -> Array:
    """Return a plane over its mean in a window, 1 where it is not known; pixels far off
    do not spread."""
    ratio = _over_mean(plane, known)
    mean, sigma, _ = clipped_moments(ratio[known])
    calm = known & (np.abs(ratio - mean) <= CUT * sigma)
    return np.where(known, _over_mean(plane, calm), np.float32(1))


def _over_mean(plane: Array, known: Array) -> Array:
    """Return a plane over the mean of what is known in a window, 1 if nothing is."""
    share = uniform_filter(known.astype(np.float32), WINDOW, mode="reflect")
    total = uniform_filter(np.where(known, plane, 0), WINDOW, mode="reflect")
    some = share > 0.5 / WINDOW**2
    return np.where(some, plane * share / np.where(some, total, 1), np.float32(1))


def field_of(
    response: Array, known: Array, sites: Sites
) -> tuple[dict[str, Measured], Array, Measured, float]:
    """Return (shading's coefficients, map, rms of the shading, rms of the rest).

    response : (H, W), relative, each site's median at 1, where it is known. Means of
    blocks of all pixels are fitted by least squares; dust is what they have besides.
    A block without a known pixel has the fit's value."""
    across = min(FIELD_BLOCKS, *(side // (4 * sites.side) for side in response.shape))
    maps = []
    for plane, used in zip(sites.of(response), sites.of(known), strict=True):
        blocks = zip(blocks_of(plane, across), blocks_of(used, across), strict=True)
        means = [clipped_moments(b[u])[0] if u.any() else np.nan for b, u in blocks]
        maps.append(np.reshape(means, (across, across)))
    field: Array = np.mean(maps, axis=0)
    height, width = response.shape
    half = math.hypot(height, width) / 2
    v, u = np.meshgrid(
        (centres(height, across, sites.side) - height / 2) / half,
        (centres(width, across, sites.side) - width / 2) / half,
        indexing="ij",
    )
    square = u**2 + v**2
    terms = (square, square**2, square**3, u, v, square * u, square * v)
    design = np.stack([t.ravel() for t in (np.ones_like(u), *terms)], 1)
    target = field.ravel()
    filled = np.isfinite(target)
    keep = filled
    for _ in range(4):
        values = np.linalg.lstsq(design[keep], target[keep], rcond=None)[0]
        target = np.where(filled, target, design @ values)
        rest = target - design @ values
        sigma = clipped_moments(rest[filled])[1]
        keep = filled & (np.abs(rest) <= CUT * sigma)
    field = target.reshape(field.shape)
    covariance = np.linalg.pinv(design[keep].T @ design[keep]) * sigma**2
    errors = np.sqrt(np.diag(covariance)) / values[0]
    shading = {
        name: Measured(float(value / values[0]), float(error), "1")
        for name, value, error in zip(SHADING, values[1:], errors[1:], strict=True)
    }
    shape = design[:, 1:] @ values[1:] / values[0]
    rms = float(np.std(shape))
    fall_off = Measured(rms, float(sigma * math.sqrt(8 / field.size)), "1")
    return shading, field, fall_off, float(np.std(rest))


def lamp_drift(groups: Sequence[Group], black: float) -> Measured | None:
    """Return the relative standard deviation of the lamp from flat to flat; None if no
    two flats repeat each other."""
    squares, freedom = 0.0, 0
    for group in groups:
        levels = np.array([scanned.mean_level - black for scanned in group.frames])
        squares += float(((levels / levels.mean() - 1) ** 2).sum())
        freedom += len(levels) - 1
    if not freedom:
        return None
    value = math.sqrt(squares / freedom)
    return Measured(value, value / math.sqrt(2 * freedom), "1")


def linearity(
    points: Sequence[TransferPoints], ceiling: float, lamp: float, white: float
) -> Linearity | None:
    """Return how level follows exposure time; None of fewer than three exposures.

    ceiling : saturation, DN above black. lamp : relative drift from flat to flat.
    white : DN above black, at which losses are told. EMVA weights deviations relative
    to the level."""
    used = [
        p
        for p in points
        if p.exposure_time
        and p.is_right
        and LOWEST * ceiling <= p.level <= HIGHEST * ceiling
    ]
    times = np.array([p.exposure_time for p in used], float)
    if len(set(times)) < FEWEST_LEVELS:
        return None
    levels = np.array([p.level for p in used])
    sigma = np.array([max(lamp, 1e-6) / math.sqrt(p.frames) for p in used])
    through_zero, _ = _relative_fit(times, levels, sigma, (1,))
    bend = float(np.abs(levels / (through_zero[0] * times) - 1).mean())
    line, _ = _relative_fit(times, levels, sigma, (0, 1))
    deviations = 100 * (levels / (line[0] + line[1] * times) - 1)
    error = float(np.abs(deviations).mean())
    chance = 100 * float(sigma.mean()) / math.sqrt(len(used))
    quadratic, cubic = _losses(times, levels, sigma, (1, 2), white)[0], None
    if len(set(times)) > FEWEST_LEVELS:
        both = _losses(times, levels, sigma, (1, 2, 3), white)
        if both[1].stands_out:
            quadratic, cubic = both
    return Linearity(
        Measured(error, chance, "%"),
        quadratic,
        cubic,
        bend,
        times,
        levels,
        deviations,
    )


def _losses(
    times: Array, levels: Array, sigma: Array, powers: Sequence[int], white: float
) -> list[Measured]:
    """Return by how much white falls short of a straight line, term by term."""
    values, errors = _relative_fit(times, levels, sigma, powers)
    a = float(values[0])
    return [
        Measured(
            float(-values[n] / a ** (n + 1) * white**n),
            float(errors[n] / abs(a) ** (n + 1) * white**n),
            "1",
        )
        for n in range(1, len(powers))
    ]


def _relative_fit(
    times: Array, levels: Array, sigma: Array, powers: Sequence[int]
) -> tuple[Array, Array]:
    """Return (coefficients of powers of t, errors) by least relative deviations."""
    design = np.stack([times**n for n in powers], 1)
    scale = np.abs(design).max(0)
    scaled = design / scale / (levels * sigma)[:, None]
    values = np.linalg.lstsq(scaled, 1 / sigma, rcond=None)[0]
    chi2 = float(((1 / sigma - scaled @ values) ** 2).sum())
    freedom = len(times) - len(powers)
    widened = np.linalg.pinv(scaled.T @ scaled) * max(
        chi2 / freedom if freedom else 1.0, 1.0
    )
    return values / scale, np.sqrt(np.diag(widened)) / scale
