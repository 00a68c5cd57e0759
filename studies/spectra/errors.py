# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How far each way to camera RGB is from what a camera sees of real spectra."""

import json
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np

import cg2raw
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.lamps import lamp_field
from cg2raw.profile.spectral import profile_from_ssf
from cg2raw.profile.spectral_file import read_sensitivities
from oracles import adobe, spectral
from studies.spectra.best_matrix import least_angle, least_squares
from studies.spectra.data import (
    LAMPS,
    LIGHTS,
    MONOCHROMATIC,
    write_lamps,
)

BEST = {"best 3x3": least_squares, "best 3x3, angle": least_angle}
METHODS = ("paper", "dng, sensor", "lamp", *BEST, "spectral")
LEAST_RATIO = 0.01  # of a neutral in a profile
# Sensitivities do not tell these; they do not matter here.
BODY = {
    "cfa": "RGGB",
    "width": 64,
    "height": 64,
    "bits": 14,
    "black_level": 0,
    "white_level": 16383,
}


@dataclass(frozen=True)
class Errors:
    """Of all cameras, each array (cameras, lights, methods, reflectances) float32."""

    cameras: tuple[str, ...]
    lights: tuple[str, ...]
    sets: dict[str, slice]  # of the reflectances
    degrees: np.ndarray
    difference: np.ndarray  # CIEDE2000

    def mean(self, which, values="degrees"):
        """Return (cameras, lights, methods): the mean over a set of reflectances."""
        return getattr(self, values)[..., self.sets[which]].mean(-1, dtype=np.float64)

    def ratio(self, which, method="best 3x3"):
        """Return (cameras, lights) of mean degrees: spectral over another method."""
        mean = self.mean(which)
        other, own = (mean[..., METHODS.index(m)] for m in (method, "spectral"))
        return own / np.where(other > 0.0, other, np.nan)


def ratios_of(neutral):
    """Return (R/G, B/G), at least what a profile may have: sodium has less blue."""
    return np.maximum(neutral[[0, 2]] / neutral[1], LEAST_RATIO)


def sensors_of(measured, words):
    """Return Sensors with the matrices for A and D65 alone, and with all lamps'.

    No matrix fits one line (profile_from_ssf refuses it): its lamp has that of A, so
    that convention spectral can name its spectrum."""
    plain = profile_from_ssf(measured, **BODY)
    lamps = [word for light, word in words.items() if light != MONOCHROMATIC]
    fitted = profile_from_ssf(measured, **BODY, lamps=lamps)
    matrix_a = np.reshape(plain["color_matrix_1"], (3, 3))
    line = illuminant_spectrum(words[MONOCHROMATIC]) @ measured.rgb
    lamp = lamp_field(words[MONOCHROMATIC], ratios_of(line), matrix_a)
    fitted["lamps"].append(lamp)
    return [cg2raw.Sensor.from_json(json.dumps(p)) for p in (plain, fitted)]


def balanced(sensor, light, convention, rgb):
    """Return camera RGB (n, 3), white 1, 1, 1, of linear Rec.709 (n, 3)."""
    image = np.concatenate([np.ones((1, 3)), rgb]).astype(np.float32)[None]
    camera = sensor.to_camera(
        image, illuminant=light, convention=convention, highlights=False
    )[0].astype(np.float64)
    return camera[1:] / camera[0]


def seen(sensors, light, neutral, rgb):
    """Return ({method: balanced camera RGB (n, 3)} of linear Rec.709 (n, 3), the
    transform of the matrices for A and D65).

    neutral : (3,) of the light. Method "dng, sensor" is both conventions: they differ
    above white alone."""
    plain, fitted = sensors
    own = light if light in ("A", "D65") else f"lamp:{light}"
    red, blue = ratios_of(neutral)
    word = f"neutral:{red:.6f}:{blue:.6f}" if light in LAMPS else light
    found = {
        "paper": balanced(plain, word, "paper", rgb),
        "dng, sensor": balanced(plain, word, "sensor", rgb),
        "lamp": balanced(fitted, own, "sensor", rgb),
        "spectral": balanced(fitted, own, "spectral", rgb),
    }
    if light == MONOCHROMATIC:
        found["lamp"] = np.full_like(rgb, np.nan)
    return found, plain.transform(word, "sensor")


def rendered(transform, camera):
    """Return XYZ D50 (n, 3) that a sensor's matrices make of balanced RGB (n, 3).

    transform : cg2raw's, camera from linear Rec.709 by the matrices of the light."""
    rgb = np.linalg.solve(transform.first, camera.T).T
    to_xyz = spectral.colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
    return rgb @ to_xyz.T @ adobe.bradford(adobe.D50, adobe.D65).T


def under(sensors, rgb_of_camera, light, word, sets):
    """Return degrees and CIEDE2000, each (methods, n), of one camera and light.

    sets : [(n, 81)]; the best matrices are those of each."""
    reflectances = np.concatenate(sets)
    response = illuminant_spectrum(word)[:, None] * rgb_of_camera
    neutral = response.sum(axis=0)
    truth = reflectances @ response / neutral
    rgb = spectral.rec709_under_d65(reflectances)
    found, transform = seen(sensors, light, neutral, rgb)
    parts = np.cumsum([len(rows) for rows in sets])[:-1]
    pairs = list(zip(np.split(rgb, parts), np.split(truth, parts), strict=True))
    for name, best in BEST.items():
        found[name] = np.concatenate([best(*pair) for pair in pairs])
    reference = rendered(transform, truth)
    cameras = [found[method] for method in METHODS]
    angles = [spectral.degrees(truth * neutral, c * neutral) for c in cameras]
    differences = [
        spectral.difference(rendered(transform, c), reference) for c in cameras
    ]
    return np.array([angles, differences], np.float32)


def of_camera(path, sets):
    """Return (2, lights, methods, n) of a file: degrees, then CIEDE2000."""
    measured = read_sensitivities(path)
    with tempfile.TemporaryDirectory() as folder:
        words = write_lamps(folder)
        sensors = sensors_of(measured, words)
        found = [
            under(sensors, measured.rgb, light, word, sets)
            for light, word in words.items()
        ]
    return np.swapaxes(found, 0, 1)


def measure(files, sets, jobs):
    """Return the Errors of camera files {name: path} over sets {name: (n, 81)}."""
    ends = np.cumsum([0, *map(len, sets.values())])
    slices = {
        name: slice(start, end)
        for name, start, end in zip(sets, ends[:-1], ends[1:], strict=True)
    }
    work = partial(of_camera, sets=list(sets.values()))
    with ProcessPoolExecutor(jobs) as pool:
        found = list(pool.map(work, files.values()))
    degrees, difference = np.swapaxes(found, 0, 1)
    return Errors(tuple(files), (*LIGHTS, *LAMPS), slices, degrees, difference)
