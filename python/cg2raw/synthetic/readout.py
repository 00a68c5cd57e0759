# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Noise, clipping, ADC: charge to DN."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy import fft

from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.light import Hidden
from cg2raw.synthetic.measured import ReadNoise
from cg2raw.synthetic.memory import with_memory

SHARES_OF_TRAPS = (0.7, 0.3)  # of the noisy pixels: one trap, or a strong one
STRONG_TRAP = 1.7  # times the noise of one trap


@dataclass(frozen=True)
class Noise:
    """How charge is read out.

    excess : variance of the photon noise over that of Poisson. poisson : whether
    photons are counted, else Gaussian. well : full well in shares of white, or inf.
    weights, variances : of a mixture of Gaussians, over the profile's read variance.
    row, frame : half the range of a row's and of a frame's offset, in read noises.
    blend : share of its 8 neighbours of the same colour in a pixel of the file.
    correlation : of the read noise of neighbours in a row.
    """

    excess: float = 1.0
    poisson: bool = False
    well: float = np.inf
    weights: tuple[float, ...] = (1.0,)
    variances: tuple[float, ...] = (1.0,)
    row: float = 0.0
    frame: float = 0.0
    blend: float = 0.0
    correlation: float = 0.0


def noise_of(hidden: Hidden) -> Noise:
    """Return the noise of a camera with hidden effects."""
    excess = np.exp(hidden.get("shot_noise", {}).get("log_gain", 0.0))
    scale = np.exp(hidden.get("read_noise", {}).get("log_variance", 0.0))
    weights, variances = np.ones(1), np.ones(1)
    if "heavy_tailed_noise" in hidden:
        v = hidden["heavy_tailed_noise"]
        weights = np.array([1 - v["share"], *(v["share"] * np.array(SHARES_OF_TRAPS))])
        variances = np.array([1.0, v["ratio"], STRONG_TRAP**2 * v["ratio"]])
        variances = variances / (weights @ variances)  # the variance stays
    well = 1 - hidden["full_well"]["below_white"] if "full_well" in hidden else 0
    row, frame = (
        float(np.sqrt(3) * hidden.get(name, {}).get("read_noises", 0.0))
        for name in ("row_noise", "black_level_drift")
    )
    return Noise(
        excess=float(excess),
        poisson="poisson_shot_noise" in hidden,
        well=well or np.inf,
        weights=tuple(weights.tolist()),
        variances=tuple((scale * variances).tolist()),
        row=row,
        frame=frame,
        blend=hidden.get("noise_reduction", {}).get("blend", 0.0),
        correlation=hidden.get("read_noise_correlation", {}).get("correlation", 0.0),
    )


def read_out(
    rng: Generator,
    charge: Plane,
    pedestal: Plane,
    noise: Noise,
    camera: Camera,
    measured: ReadNoise | None = None,
) -> NDArray[np.uint16]:
    """Return one frame, (H, W) DN, of an expected charge.

    measured : what is read with in place of a mixture of Gaussians.

    Charge is drawn, clipped at the full well, read; the ADC clips at white and rounds;
    noise reduction mixes before it rounds."""
    shape = charge.shape
    normal = rng.standard_normal(shape)
    spread = np.sqrt(noise.excess)
    if noise.poisson:
        drawn = charge + spread * (rng.poisson(charge) - charge)
    else:
        drawn = charge + spread * np.sqrt(charge) * normal
    drawn = np.minimum(drawn, noise.well * camera.over(camera.full_well, shape))
    if measured:
        drawn = drawn + camera.over(camera.read_noise, shape) * measured.draw(
            rng, shape
        )
    else:
        drawn = drawn + _mixture(rng, shape, noise, camera)
    level = pedestal + camera.over(camera.dn_per_electron, shape) * drawn
    half = noise.row * row_unit(camera)
    level = level + rng.uniform(-1, 1, (shape[0], 1)) * half
    if noise.frame:
        level = level + rng.uniform(-1, 1) * noise.frame * row_unit(camera)
    level = np.clip(level, 0, camera.white)
    if noise.blend:
        level = blended(level, noise.blend)
    rounded: Plane = np.clip(np.floor(level + 0.5), 0, camera.white)
    return rounded.astype(np.uint16)


def _mixture(
    rng: Generator, shape: tuple[int, int], noise: Noise, camera: Camera
) -> Plane:
    kind = rng.choice(len(noise.weights), size=shape, p=noise.weights)
    read = camera.over(camera.read_noise, shape) * np.sqrt(noise.variances)[kind]
    normal = rng.standard_normal(shape)
    if noise.correlation:
        normal = with_memory(rng, normal, noise.correlation)
    return read * normal


def row_unit(camera: Camera) -> float:
    """Return the read noise in DN, on average over the sites."""
    return float((camera.dn_per_electron * camera.read_noise).mean())


def blend_response(shape: tuple[int, int], blend: float) -> Plane:
    """Return what a blend does to the cosines of one colour's (h, w) sites.

    The 8 neighbours count alike; beyond an edge the pixels are mirrored."""
    v = np.cos(np.pi * np.arange(shape[0]) / shape[0])[:, None]
    u = np.cos(np.pi * np.arange(shape[1]) / shape[1])[None]
    response: Plane = 1 - blend + blend / 8 * (2 * u + 2 * v + 4 * u * v)
    return response


def blended(level: Plane, blend: float, inverse: bool = False) -> Plane:
    """Return the mosaic with every colour's sites blended, or as it was before that."""
    result = np.empty_like(level)
    for row in range(2):
        for col in range(2):
            sites = level[row::2, col::2]
            response = blend_response(sites.shape, blend)
            response = 1 / response if inverse else response
            cosines = fft.dctn(sites, type=2) * response
            result[row::2, col::2] = fft.idctn(cosines, type=2)
    return result
