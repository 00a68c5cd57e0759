# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A made-up diagnosis: what a camera with vignetting and row noise might give."""

import json
import math

import numpy as np

from cg2raw.diagnose.diagnosis import (
    Alternative,
    Chart,
    Curve,
    DetectionLimit,
    Diagnosis,
    Estimate,
    Finding,
    Gap,
    Picture,
    ResidualTest,
    Series,
)

R2, R4 = -0.34, 0.05
WHITE = 16000.0  # DN above black
NEUTRAL = (0.52, 1.0, 0.68)


def picture(name, kind, height, width, seed):
    """Return a frame whose corners are darker than its simulation before."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    waves = 0.4 + 0.3 * np.sin(9 * x) * np.cos(7 * y)
    light = waves * {"dark": 0.0, "flat": 1.0}.get(kind, 1 + 0.2 * (x > y))
    before = light[..., None] * NEUTRAL
    r2 = (x**2 + y**2)[..., None] / 2
    after = before * (1 + R2 * r2 + R4 * r2**2)
    measured = after + 0.004 * rng.standard_normal(before.shape)
    z_after = rng.standard_normal((height, width))
    z_before = z_after + 20 * (after - before).mean(axis=-1)
    z_after[: height // 12, : width // 9] = np.nan
    arrays = (measured.clip(0, 1), before, after, z_before, z_after)
    return Picture(name, kind, *(a.astype(np.float32) for a in arrays), neutral=NEUTRAL)


def pictures(count=3, height=40, width=60):
    """Return @count frames: scenes, a flat and a dark in turn."""
    kinds = ("scene", "flat", "scene", "dark")
    names = [f"{kinds[n % 4]}_{n}.dng" for n in range(count)]
    return [
        picture(name, kinds[n % 4], height, width, n) for n, name in enumerate(names)
    ]


def curves():
    """Return a fall-off and a photon transfer curve."""
    rng = np.random.default_rng(3)
    r, s = np.linspace(0, 1, 60), np.linspace(0, 1, 60)
    fall = 1 + R2 * r**2 + R4 * r**4
    at = np.linspace(0.03, 0.99, 24)
    seen = 1 + R2 * at**2 + R4 * at**4 + 0.006 * rng.standard_normal(24)
    variance = 3.1e-6 + 2.4e-4 * s
    points = (3.1e-6 + 2.4e-4 * at) * (1 + 0.03 * rng.standard_normal(24))
    return [
        Curve("Relative illumination", "radius (1: corner)", "relative signal",
              r, fall, fall - 0.004 - 0.01 * r, fall + 0.004 + 0.01 * r, at, seen,
              "lens_shading"),
        Curve("Photon transfer", "signal (1: white level)", "variance",
              s, variance, 0.97 * variance, 1.03 * variance, at, points, "row_noise"),
    ]  # fmt: skip


def charts():
    """Return what darks and flats show of row noise, of two sites, and of all."""
    x = np.array([0.0, 1.0, 10.0, 30.0])
    noise = np.array([0.41, 0.43, 0.40, 0.42])
    one = Series("", x, noise, np.full(4, 0.1), np.full(4, 0.412))
    red, green = (
        Series(name, x + 1, n * x, np.zeros(4), 1.01 * n * x)
        for n, name in enumerate(("R", "Gb"), 1)
    )
    drift = Series("", x, x - 10, np.full(4, 0.1), np.full(4, 12.0))
    lines = ("exposure time, s", "rms, DN")
    return [
        Chart("row_noise", "Noise of rows", *lines, [one]),
        Chart("", "Level of flats", "signal, DN", "deviation, %", [red, green]),
        Chart("", "Levels of darks", "dark, in order", "DN", [drift], "bands"),
        Chart("", "Correlation", "", "r", [one], "bars", ["right", "down", "a", "b"]),
    ]


def residual_tests(scale):
    """Return tests whose sizes are @scale of those of the made-up camera."""
    names = [f"mean by {each}" for each in ("radius", "tile", "row", "level")]
    names += [f"variance by {each}" for each in ("row", "level", "radius")]
    names += [f"autocorrelation {each}" for each in ("0,1", "1,0", "1,1")]
    names += ["gradient, radial red", "gradient, vertical", "kurtosis", "repeats"]
    tests = []
    for number, name in enumerate(names):
        size = scale * 0.3 * math.exp(-0.62 * number)
        statistic = math.sqrt(2e5 * size)
        p_value = math.exp(-min(600, statistic**2 / 2))
        where = "corners, all channels alike" if "radius" in name else "nowhere special"
        tests.append(ResidualTest(name, statistic, p_value, size, where))
    return tests


def histogram(deviation):
    """Return (edges, counts) of normal residuals with that standard deviation."""
    edges = np.linspace(-8, 8, 81)
    draws = np.random.default_rng(5).normal(0, deviation, 400_000)
    return edges, np.histogram(draws, edges)[0]


def findings():
    """Return the two effects."""
    shading = Finding(
        "lens_shading",
        {"r2": Estimate(-0.3412, "1", (-0.3441, -0.3383)),
         "r4": Estimate(0.0518, "1", (0.0466, 0.0570)),
         "r6": Estimate(-0.0004, "1", (-0.0031, 0.0023))},
        18342.1, 1e300,
        [Alternative("veiling_glare", 212.0), Alternative("nonlinearity", 96.4)],
        [], "falls off with radius, all channels, in proportion to signal",
        "Lens shading: the lens loses 29 % at the corner.",
    )  # fmt: skip
    rows = Finding(
        "row_noise",
        {"sigma": Estimate(0.412 / WHITE, "1", (0.381 / WHITE, 0.447 / WHITE))},
        31.7, 5.8e13,
        [Alternative("read_noise", 28.9)],
        ["read_noise"], "whole rows, new in each frame",
        "Row noise: standard deviation 0.41 DN.",
    )  # fmt: skip
    return [shading, rows]


def detection_limits():
    """Return smallest visible strengths, one of them out of reach."""
    return [
        DetectionLimit("exposure", "gain", 4.2e-4, "1"),
        DetectionLimit("white_balance", "red", 7e-4, "1"),
        DetectionLimit("black_level", "offset_00", 0.02, "DN"),
        DetectionLimit("dark_current", "per_second", None, "1/s"),
    ]


def made_up_diagnosis(**changes):
    """Return a Diagnosis with every field filled; @changes replace fields."""
    fields = {
        "verdict": "explained",
        "sensor_id": "nikon-d40",
        "effects": findings(),
        "gap": Gap(0.4113, 0.00031, 3.214, 1.0012,
                   ["scene_0.dng", "flat_1.dng", "scene_2.dng"],
                   (0.4021, 0.4208), (0.00012, 0.00049)),
        "tests_before": residual_tests(1.0),
        "tests_after": residual_tests(1e-5),
        "unexplained": [ResidualTest("row autocorrelation", 4.1, 2e-5, 2.3e-4,
                                     "odd rows of the left half")],
        "detection_limits": detection_limits(),
        "next_captures": ["Ten darks of one exposure time would tell row noise from "
                          "read noise."],
        "notes": ["The exposure of every set is a free nuisance.",
                  "Lateral chromatic aberration was not tested: no frame has edges."],
        "groups": {"fit": ["shot_1.dng", "dark_0.dng"], "select": ["shot_4.dng"],
                   "report": ["scene_0.dng", "flat_1.dng", "scene_2.dng"]},
        "pictures": pictures(),
        "curves": curves(),
        "charts": charts(),
        "histogram_before": histogram(1.8),
        "histogram_after": histogram(1.0),
        "profile_json": json.dumps({"id": "nikon-d40", "effects": ["lens_shading"]},
                                   indent=2),
        "white_dn": WHITE,
        "electrons_per_dn": 2.083,
        "seconds": 12.34,
    }  # fmt: skip
    return Diagnosis(**{**fields, **changes})
