# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What is known of fixed patterns from the frames that may be fitted.

The true pattern of a sensor is not to be had from a few noisy frames. A fair oracle
knows the law that the pattern was drawn from and its posterior, given the fit frames:
here the best linear one, which is exact where pattern and noise are Gaussian.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.charge import Patterns, uneven_dark
from cg2raw.synthetic.light import Hidden

PIXEL_PATTERNS = ("gain", "leak", "offset")


@dataclass(frozen=True)
class Observation:
    """One frame that can be fitted, in DN.

    residual : measured minus expected without patterns. variance : of its noise.
    usable : (H, W), not clipped. slopes : of the level by gain, leak and offset.
    """

    residual: Plane
    variance: Plane
    usable: Plane
    slopes: tuple[Plane, Plane, Plane]


@dataclass(frozen=True)
class Posterior:
    """mean : patterns. covariance : (H, W, 3, 3) of gain, leak, offset of a pixel.
    column : (W,) variance, electrons^2."""

    mean: Patterns
    covariance: Plane
    column: Plane

    def variance(self, slopes: tuple[Plane, Plane, Plane]) -> Plane:
        """Return what a level is unsure by, DN^2."""
        b = np.stack(slopes, -1)
        pixel: Plane = np.einsum("hwi,hwij,hwj->hw", b, self.covariance, b)
        return pixel + slopes[2] ** 2 * self.column


def prior_variances(hidden: Hidden, camera: Camera, truth: Patterns) -> Plane:
    """Return (H, W, 3) variances of gain, leak and offset before any frame is seen.

    Which pixels are hot is taken as known: a search sees nearly all that matter."""
    prior = np.zeros((*truth.gain.shape, 3))
    read = float(camera.read_noise.mean())
    if "prnu" in hidden:
        prior[..., 0] = hidden["prnu"]["sigma"] ** 2
    if "hot_pixels" in hidden:  # second moment of an exponential law
        rate = hidden["hot_pixels"]["electrons_per_second"]
        prior[..., 1] = np.where(truth.hot, 2 * rate**2, 0.0)
    if "dark_current_nonuniformity" in hidden:
        law = uneven_dark(hidden["dark_current_nonuniformity"])
        prior[..., 1] += law.var()
    if "dsnu" in hidden:
        prior[..., 2] = (hidden["dsnu"]["read_noises"] * read) ** 2
    return prior


def posterior(
    frames: Sequence[Observation], hidden: Hidden, camera: Camera, truth: Patterns
) -> Posterior:
    """Return what the fit frames say of a sensor's patterns."""
    prior = prior_variances(hidden, camera, truth)
    column, column_variance = _columns(frames, prior, hidden, camera)
    precision = np.zeros((*truth.gain.shape, 3, 3))
    pull = np.zeros((*truth.gain.shape, 3))
    for frame in frames:
        b = np.stack(frame.slopes, -1)
        weight = frame.usable / frame.variance
        residual = frame.residual - frame.slopes[2] * column
        precision += (weight[..., None] * b)[..., None] * b[..., None, :]
        pull += (weight * residual)[..., None] * b
    # With S the prior's deviations: S (1 + S P S)^-1 S, also where a prior is 0.
    s = np.sqrt(prior)
    inner = np.linalg.inv(np.eye(3) + s[..., None] * precision * s[..., None, :])
    covariance = s[..., None] * inner * s[..., None, :]
    mean = np.einsum("hwij,hwj->hwi", covariance, pull)
    fields = dict(zip(PIXEL_PATTERNS, np.moveaxis(mean, -1, 0), strict=True))
    found = replace(truth, column=column, **fields)
    return Posterior(found, covariance, column_variance)


def _columns(
    frames: Sequence[Observation], prior: Plane, hidden: Hidden, camera: Camera
) -> tuple[Plane, Plane]:
    """Return mean and variance of the columns' offsets, electrons; the patterns of
    pixels count as noise, the same in all frames."""
    width = prior.shape[1]
    if "column_fixed_pattern" not in hidden:
        return np.zeros(width), np.zeros(width)
    read = float(camera.read_noise.mean())
    sigma = hidden["column_fixed_pattern"]["read_noises"] * read
    weight, pull = np.zeros((2, *prior.shape[:2]))
    for frame in frames:
        gain = frame.slopes[2]
        weight += frame.usable * gain**2 / frame.variance
        pull += frame.usable * gain * frame.residual / frame.variance
    mean_gain = np.mean([frame.slopes[0] / frame.slopes[2] for frame in frames], axis=0)
    seconds = np.mean([frame.slopes[1] / frame.slopes[2] for frame in frames], axis=0)
    pattern = prior @ np.array([0, 0, 1.0])
    pattern = pattern + prior[..., 0] * mean_gain**2 + prior[..., 1] * seconds**2
    seen = pull / np.maximum(weight, 1e-30)
    sure = np.where(weight > 0, 1 / (1 / np.maximum(weight, 1e-30) + pattern), 0.0)
    total = sure.sum(0)
    variance = 1 / (1 / sigma**2 + total)
    return variance * (sure * seen).sum(0), variance
