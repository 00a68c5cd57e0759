# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral images: what a sensor sees of the radiance at each wavelength."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cg2raw import _core
from cg2raw.argument_types import thread_count
from cg2raw.arrays import FloatImage
from cg2raw.exposure import Light, illuminant_word
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor

# A spectrum: (wavelength in nm, power), ...
Rows = list[tuple[float, float]]


class Seen(TypedDict):
    """Some fields of a Run."""

    convention: str
    camera_input: bool


# Of a Run whose image is camera RGB of spectra.
SEEN: Seen = {"convention": "sensor", "camera_input": True}
ESTIMATE = "estimate"
STEP = 1e-6  # nm, between the two ends of a step in a spectrum of boxes


@dataclass(frozen=True)
class Statistic:
    """What an image's light is taken for: each bin's number of all pixels, times any
    factor that is the same for all bins."""

    about: str
    combine: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
    of_row: Callable[[FloatImage], NDArray[np.float64]]  # (W, N) -> (N,)

    def of(self, parts: Iterable[FloatImage]) -> NDArray[np.float64]:
        """Return (N,) of an image's (h, w, N) parts; values that are not finite, and
        negative ones, count as 0."""
        found = None
        for part in parts:
            for row in part:
                legal = np.where(np.isfinite(row), np.maximum(row, 0.0), 0.0)
                one = self.of_row(legal)
                found = one if found is None else self.combine(found, one)
        assert found is not None  # an image has pixels
        return found


STATISTICS = {
    "mean": Statistic(
        "grey world", np.add, lambda row: row.sum(axis=0, dtype=np.float64)
    ),
    "max": Statistic(
        "brightest", np.maximum, lambda row: row.max(axis=0).astype(np.float64)
    ),
}


def is_estimate(illuminant: Light) -> bool:
    """Return whether a word asks for the light of the image itself."""
    if not isinstance(illuminant, str):
        return False
    return illuminant.lower().partition(":")[0] == ESTIMATE


def estimated_light(
    word: str,
    stated: Rows | None,
    centres: Sequence[float],
    measure: Callable[[Statistic], NDArray[np.float64]],
) -> Rows:
    """Return the spectrum of the light that "estimate" or "estimate:mean" asks for.

    stated : what the image states; centres : of its bins, nm; measure : gives a
    Statistic of the image, (N,). Raises ValueError."""
    name = word.lower().partition(":")[2]
    known = ", ".join(f"{ESTIMATE}:{key} ({s.about})" for key, s in STATISTICS.items())
    if not name:
        if stated is None:
            raise ValueError(
                f"illuminant {word}: the image states no light's spectrum (attribute "
                f'illuminant, "400nm:0.3;410nm:0.5;..."): name the light, or {known}'
            )
        return stated
    if name not in STATISTICS:
        raise ValueError(f"illuminant {word}: {ESTIMATE} as the image states, {known}")
    values = measure(STATISTICS[name])
    if not values.max() > 0.0:
        raise ValueError(f"illuminant {word}: the image is black; name the light")
    return boxes(centres, values)


def boxes(centres: Sequence[float], values: NDArray[np.float64]) -> Rows:
    """Return the spectrum of boxes that reach half way to their neighbours."""
    inner = 0.5 * (np.asarray(centres[1:]) + np.asarray(centres[:-1]))
    ends = (2 * centres[0] - inner[0], 2 * centres[-1] - inner[-1])
    edges = np.concatenate([ends[:1], inner, ends[1:]])
    rows = zip(edges[:-1].tolist(), edges[1:].tolist(), values.tolist(), strict=True)
    return [(nm, value) for a, b, value in rows for nm in (a + STEP, b - STEP)]


def seen_light(
    sensor: Sensor,
    illuminant: Light,
    estimate: Callable[[str], Rows],
) -> tuple[_core.Illuminant | Rows, str]:
    """Return (the light, the word for what is white as the sensitivities see it).

    estimate : gives the spectrum of a word for which is_estimate holds.
    Raises ValueError."""
    profile = sensor.profile
    if isinstance(illuminant, str) and is_estimate(illuminant):
        power = estimate(illuminant)
        return power, _core.neutral_word(profile, power)
    word = illuminant_word(illuminant, sensor.id)
    light = profile.illuminant(word)
    return light, _core.seen_by_sensitivities(profile, word)


def camera_from_spectra(
    sensor: Sensor,
    spectra: ArrayLike,
    wavelengths: Sequence[float],
    *,
    illuminant: Light,
    white: float,
    threads: int = 0,
) -> FloatImage:
    """Return (H, W, 3) float32 camera RGB of a spectral image, white at 1, not clipped.

    sensor : Sensor with spectral_sensitivities.
    spectra : (H, W, N) float, spectral radiance in W/(m2 sr nm). Each bin is a box that
        reaches half way to its neighbours.
    wavelengths : (N,) centres of the bins, nm, rising.
    illuminant : word or Illuminant whose spectrum white has; or "estimate:mean", each
        bin's mean (grey world), or "estimate:max", its largest value.
    white : cd/m2 of a perfect diffuser under that light, at which the sensor's most
        sensitive channel is 1.

    Raises ValueError."""
    camera, _ = seen(sensor, spectra, wavelengths, illuminant, white, threads)
    return camera


def simulate_spectra(
    sensor: Sensor,
    spectra: ArrayLike,
    wavelengths: Sequence[float],
    *,
    illuminant: Light,
    white: float,
    iso: float | None = None,
    noise: str | None = None,
    seed: int = 0,
    frame: int = 0,
    effects: bool = True,
    as_shot: Sequence[float] | None = None,
    exposure_time: float | None = None,
    color_effects: bool = True,
    threads: int = 0,
) -> RawFrame:
    """Return the RAW frame, (H, W) uint16 DN, of a spectral image, as the plugin does.

    iso, noise, seed, frame, effects, as_shot, exposure_time, color_effects : as of
        cg2raw.Run; all else as of camera_from_spectra. Raises ValueError."""
    camera, word = seen(sensor, spectra, wavelengths, illuminant, white, threads)
    return sensor.simulate(
        camera,
        illuminant=word,
        iso=iso,
        noise=noise,
        seed=seed,
        frame=frame,
        effects=effects,
        as_shot=as_shot,
        exposure_time=exposure_time,
        color_effects=color_effects,
        threads=thread_count(threads),
        **SEEN,
    )


def seen(
    sensor: Sensor,
    spectra: ArrayLike,
    wavelengths: Sequence[float],
    illuminant: Light,
    white: float,
    threads: int,
) -> tuple[FloatImage, str]:
    """Return (camera RGB, the word for what is white) of a spectral image."""
    centres = np.asarray(wavelengths, np.float64)
    if centres.ndim != 1 or len(centres) < 2 or not np.all(np.diff(centres) > 0.0):
        raise ValueError("wavelengths must be two or more numbers in nm that rise")
    image = np.asarray(spectra)
    if image.dtype.kind != "f":
        raise ValueError(f"spectra must be float, not {image.dtype}")
    if image.ndim != 3 or image.shape[2] != len(centres):
        raise ValueError(
            f"spectra must be an array of shape (height, width, {len(centres)}), a bin "
            f"per wavelength, not {image.shape}"
        )
    image = image.astype(np.float32, copy=False)

    def estimate(word: str) -> Rows:
        return estimated_light(word, None, centres.tolist(), lambda s: s.of([image]))

    light, word = seen_light(sensor, illuminant, estimate)
    response = _core.SpectralResponse(sensor.profile, light, centres.tolist(), white)
    return response.to_camera(image, threads=thread_count(threads)), word
