# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Phase correlation: how far a render is shifted, and whether it matches at all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cg2raw.diagnose.diagnosis import LARGEST_SHIFT

# Of the Gaussian that a shift's peak becomes, cells: wide enough for its three highest
# samples to be above the noise, narrow enough for two peaks to stay apart.
PEAK_SIGMA = 1.0
SLOW = 3.0  # cells; what is slower does not say where edges lie
LEAST_ALIKE = 0.5  # correlation of a capture and its render, of what noise leaves of it
CONTRAST = 3.0  # standard deviations of noise, of an image that has any; of chance

# px, the median of a set's renders: of 1,800 that lay right, with whatever effect, one
# had 0.2, and one whose lines jitter 0.4.
MISPLACED = 0.3


@dataclass(frozen=True)
class Shift:
    """down, right : of the second plane against the first, in its samples.

    correlation : of both planes, when shifted so; 1 for one picture, about 0 for two.
    """

    down: float
    right: float
    correlation: float

    @property
    def is_told(self) -> bool:
        """Whether both are alike enough for this to be where the second lies."""
        return self.correlation >= LEAST_ALIKE


def shift_between(first: NDArray[np.floating], second: NDArray[np.floating]) -> Shift:
    """Return the shift of (H, W) @second against @first, to a tenth of a sample.

    Their spectra's phases alone count, so that neither brightness nor smooth shading
    matters. Source: C. D. Kuglin and D. C. Hines, Proc. IEEE Int. Conf. Cybernetics and
    Society, 1975; the peak is made a Gaussian, whose logarithm is a parabola."""
    spectra = [np.fft.rfft2(windowed(plane)) for plane in (first, second)]
    cross = np.conj(spectra[0]) * spectra[1]
    size = np.abs(cross)
    cross = np.divide(cross, size, out=np.zeros_like(cross), where=size > 0)
    height, width = first.shape
    down = np.fft.fftfreq(height)[:, None]
    right = np.fft.rfftfreq(width)[None, :]
    cross *= np.exp(-2 * (np.pi * PEAK_SIGMA) ** 2 * (down**2 + right**2))
    surface = np.fft.irfft2(cross, s=first.shape)
    row, col = np.unravel_index(np.argmax(surface), surface.shape)
    down_by = wrapped(row + vertex(surface[:, col], int(row)), height)
    right_by = wrapped(col + vertex(surface[row, :], int(col)), width)
    nearest = round(down_by), round(right_by)
    return Shift(down_by, right_by, correlation_at(first, second, *nearest))


def windowed(plane: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return a plane without mean and edges."""
    values = plane - plane.mean(dtype=np.float64)
    window: NDArray[np.float64] = (
        values * np.hanning(plane.shape[0])[:, None] * np.hanning(plane.shape[1])
    )
    return window


def vertex(line: NDArray[np.float64], peak: int) -> float:
    """Return how far beside its highest sample the peak of a line is."""
    floor = 1e-6 * line[peak]
    below, at, above = (
        np.log(max(line[(peak + step) % len(line)], floor)) for step in (-1, 0, 1)
    )
    bend = below - 2 * at + above
    return float(np.clip((below - above) / (2 * bend), -0.5, 0.5)) if bend < 0 else 0.0


def wrapped(shift: float, length: int) -> float:
    """Return a shift in -length / 2 .. length / 2."""
    return float((shift + length / 2) % length - length / 2)


def correlation_at(
    first: NDArray[np.floating], second: NDArray[np.floating], down: int, right: int
) -> float:
    """Return the correlation of what two planes share when the second is moved back."""
    return correlation(*shared(first, second, down, right))


def shared(
    first: NDArray[np.floating], second: NDArray[np.floating], down: int, right: int
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Return what two planes share when the second is moved back."""
    height, width = first.shape
    a = first[max(-down, 0) : height - max(down, 0), max(-right, 0) :]
    b = second[max(down, 0) : height - max(-down, 0), max(right, 0) :]
    return a[:, : width - abs(right)], b[:, : width - abs(right)]


def correlation(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    """Return the correlation of two images; 0 if one has no contrast."""
    if np.ptp(a) == 0 or np.ptp(b) == 0:
        return 0.0
    a, b = a - a.mean(dtype=np.float64), b - b.mean(dtype=np.float64)
    return float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))


def likeness(
    signal: NDArray[np.floating], mean: NDArray[np.floating], noise: float
) -> float:
    """Return the correlation of a capture with its render over the most that it can
    have: noise, and all else that a render lacks, leave the share of its contrast in
    that of the capture. 1 or more where there is too little to tell.

    signal, mean : the same pixels of both. noise : standard deviation of signal."""
    if mean.std() < noise / CONTRAST:
        return 0.0 if signal.std() > CONTRAST * noise else 1.0
    most = min(mean.std() / max(signal.std(), 1e-30), 1.0)
    return float((correlation(signal, mean) + CONTRAST / np.sqrt(mean.size)) / most)


def edges(
    image: NDArray[np.floating], usable: NDArray[np.bool_]
) -> NDArray[np.floating]:
    """Return an image without its slow part, 0 where it is not usable."""
    weight = gaussian_filter(usable.astype(float), SLOW)
    slow = gaussian_filter(np.where(usable, image, 0), SLOW) / np.maximum(weight, 1e-9)
    return np.where(usable, image - slow, 0)


def misplaced_words(shifts: Sequence[Shift]) -> str:
    """Return what is said of renders, whose shifts are px, that lie beside their
    captures where nothing takes that up; "" if they do not."""
    if not shifts:
        return ""
    down, right = np.median([(one.down, one.right) for one in shifts], axis=0)
    if max(abs(down), abs(right)) <= MISPLACED:
        return ""
    return (
        f"renders are {down:+.1f} px down, {right:+.1f} px right of their captures, in "
        "the median: add registration to nuisance, which takes up "
        f"{LARGEST_SHIFT:g} px, or effects would be named for it"
    )


def unlike_words(alike: float) -> str:
    """Return what is said of a render of something else. alike : as of likeness."""
    return (
        f"the scene does not correspond to the capture: they correlate by {alike:.2f} "
        f"of what noise leaves, and {LEAST_ALIKE} is the least: is it the render of "
        "this frame, of the same view and crop, and are both the same way up?"
    )


def far_words(down: float, right: float) -> str:
    """Return what is said of a render that lies too far from its capture, px."""
    return (
        f"its render is {down:+.1f} px down, {right:+.1f} px right of it; a diagnosis "
        f"takes up {LARGEST_SHIFT:g} px"
    )
