# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Small capture sets on disk: frames of a bundled sensor, and their manifests."""

import numpy as np

import cg2raw
from cg2raw.diagnose.captures.check import check
from cg2raw.diagnose.captures.reader import read_captures, read_frames
from dng import dng_files

SHAPE = (48, 64)
SENSOR = "samsung-s20fe"
ISO = 100


def picture(shape=SHAPE, seed=1):
    """Return (H, W, 3) float32 of boxes in random colours, 0.05 to 0.9."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(0.05, 0.9, (shape[0] // 4, shape[1] // 4, 3))
    return np.kron(coarse, np.ones((4, 4, 1))).astype(np.float32)


def frame(folder, name, rgb=None, *, frame=0, illuminant="D65", **shot):
    """Write a DNG of SENSOR, or an .npy, by the ending; return its DN."""
    sensor = cg2raw.Sensor(SENSOR)
    rgb = np.zeros((*SHAPE, 3), np.float32) if rgb is None else rgb
    run = {"illuminant": illuminant, "iso": ISO, "frame": frame, "highlights": False}
    raw = sensor.simulate(rgb, **run)
    if name.endswith(".npy"):
        np.save(folder / name, np.asarray(raw))
    else:
        cg2raw.write_dng(folder / name, raw, shot=shot)
    return np.asarray(raw)


def manifest(folder, frames, top=f"sensor: {SENSOR}"):
    """Write captures.yaml of lines of frames; return its path."""
    path = folder / "captures.yaml"
    path.write_text("\n".join([top, "frames:", *(f"  - {line}" for line in frames)]))
    return path


def read_series(folder, fields, *top):
    """Write N.npy and a line for each of @fields; return what is read of them."""
    lines = []
    for index, words in enumerate(fields):
        frame(folder, f"{index}.npy", frame=index)
        lines.append(f"{{file: {index}.npy, {words}}}")
    return read_captures(manifest(folder, lines, *top))


def checked(folder, lines):
    """Return what a check of frames says."""
    _, sensor, frames, _ = read_frames(manifest(folder, lines))
    return check(frames, sensor)


def standard_set(folder, most=None):
    """Write three darks, three flats and three scenes; return the manifest's path."""
    lines = []
    for index in range(3):
        frame(folder, f"dark_{index}.dng", frame=index, exposure_time=0.5)
        lines.append(f"{{file: dark_{index}.dng, kind: dark}}")
    for index, level in enumerate((0.2, 0.4, 0.6)):
        flat = np.full((*SHAPE, 3), level, np.float32)
        frame(folder, f"flat_{index}.dng", flat, frame=10 + index)
        lines.append(f"{{file: flat_{index}.dng, kind: flat, scene: {level}}}")
    for index in range(3):
        rgb = picture(seed=index)
        np.save(folder / f"render_{index}.npy", rgb)
        frame(folder, f"shot_{index}.dng", rgb, frame=20 + index)
        line = f"{{file: shot_{index}.dng, kind: scene, scene: render_{index}.npy}}"
        lines.append(line)
    return manifest(folder, lines[:most])


def other_sensor(**changes):
    """Return SENSOR with fields of its profile changed."""
    return dng_files.sensor(SENSOR, **changes)
