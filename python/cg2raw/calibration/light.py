# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Light: shading, linearity, and the lamp's drift.

Source: EMVA Standard 1288, release 4.0, section on linearity; D. B. Goldman, IEEE
Trans. PAMI 32(12), 2010 (the shading's polynomial)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.measured import Measured
from cg2raw.calibration.photon_transfer import TransferPoints
from cg2raw.calibration.robust import Array, clipped_moments, linear_fit
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import FIELD_BLOCKS, Sites, blocks_of, centres

SHADING = ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
LOWEST, HIGHEST = 0.05, 0.95  # of saturation, between which linearity is judged
FEWEST_LEVELS = 3


@dataclass(frozen=True)
class Light:
    """Response to uniform light.

    shading : {coefficient: value}, of lens_shading. fall_off : relative, rms of that
    shading over the field. residual : relative, rms of what it leaves of the map.
    field : (blocks, blocks) relative response. noise : relative variance of a pixel of
    the mean flat by temporal noise."""

    shading: dict[str, Measured]
    fall_off: Measured
    residual: float
    field: Array
    noise: float


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


def light_of(mean: NDArray[np.float32], known: Array, seen: Seen, number: int) -> Light:
    """Return the response of the mean of a group of flats, by its number.

    mean : (H, W) DN above black and dark; in place, each site's median comes to 1, as
    does what is not known. known : (H, W) bool."""
    sites, noise = seen.sites, seen.noise(number).site_variance
    relative = []
    pairs = zip(sites.of(mean), sites.of(known), noise, strict=True)
    for plane, used, variance in pairs:
        level = float(np.median(plane[used]))
        plane /= np.float32(level)
        relative.append(variance / level**2 / seen.statistics.frames[number])
    shading, field, fall_off, residual = field_of(mean, known, sites)
    mean[~known] = 1
    return Light(shading, fall_off, residual, field, float(np.mean(relative)))


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
    filled = np.isfinite(field.ravel())
    fit = linear_fit(design[filled], field.ravel()[filled])
    values, said = fit.values, design @ fit.values
    field = np.where(filled, field.ravel(), said).reshape(field.shape)
    errors = np.sqrt(np.diag(fit.covariance)) / values[0]
    shading = {
        name: Measured(float(value / values[0]), float(error), "1")
        for name, value, error in zip(SHADING, values[1:], errors[1:], strict=True)
    }
    shape = design[:, 1:] @ values[1:] / values[0]
    rms = float(np.std(shape))
    fall_off = Measured(rms, math.sqrt(fit.variance * 8 / field.size), "1")
    return shading, field, fall_off, float(np.std(fit.rest))


def lamp_drift(groups: Sequence[Array]) -> Measured | None:
    """Return the relative standard deviation of the lamp from flat to flat; None if no
    two flats repeat each other. groups : of each, (frames,) DN above black."""
    freedom = sum(len(levels) - 1 for levels in groups)
    if not freedom:
        return None
    rests = [levels / levels.mean() - 1 for levels in groups]
    value = math.sqrt(sum(float(rest @ rest) for rest in rests) / freedom)
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
