# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Diagnoses as the engine would return them, for what is done with them."""

import numpy as np

from cg2raw.diagnose.diagnosis import (
    Alternative,
    Curve,
    DetectionLimit,
    Diagnosis,
    Estimate,
    Finding,
    Gap,
    Picture,
    ResidualTest,
)


def finding(**changes):
    """Return a lens shading that was found."""
    return Finding(
        **{
            "name": "lens_shading",
            "parameters": {
                "r2": Estimate(-0.31, "1", (-0.32, -0.3)),
                "tilt_x": Estimate(np.float64(0.0), "1", (-np.inf, np.inf)),
            },
            "gain_nats": 18342.1,
            "e_value": 1e300,
            "alternatives": [Alternative("veiling_glare", 212.0)],
            "ambiguous_with": (),
            "where": "falls off with radius, all channels, in proportion to signal",
            "sentence": "the lens loses 31 % at the corner",
            **changes,
        }
    )


def gap(**changes):
    """Return a gap that was closed."""
    return Gap(
        **{
            "before": 0.41,
            "after": np.float32(0.0003),
            "chi2_before": 3.2,
            "chi2_after": 1.001,
            "held_out": ["shot_7.dng"],
            **changes,
        }
    )


def diagnosis(verdict="explained", **changes):
    """Return a Diagnosis with something in every field."""
    test = ResidualTest("row autocorrelation", 4.1, 1e-5, 3e-4, "rows, all channels")
    small = np.zeros((4, 4, 3), np.float32)
    line = np.linspace(0, 1, 5)
    fields = {
        "verdict": verdict,
        "sensor_id": "nikon-d40",
        "effects": [finding()],
        "gap": gap(),
        "tests_before": [test],
        "tests_after": [],
        "unexplained": [test],
        "detection_limits": [
            DetectionLimit("blur", "ring_1", None, "1"),
            DetectionLimit("prnu", "sigma", 0.1, ""),
        ],
        "next_captures": ["add flats at two levels"],
        "notes": ["exposure is a free nuisance"],
        "groups": {"fit": ["a.dng"], "select": ["b.dng"], "report": ["shot_7.dng"]},
        "pictures": [Picture("shot_7.dng", "scene", small, small, small,
                             small[..., 0], small[..., 0])],
        "curves": [Curve("fall-off", "r", "gain", *[line] * 6, "lens_shading")],
        "histogram_before": (line, line[1:]),
        "histogram_after": (line, line[1:]),
        "profile_json": "{}",
        "seconds": 12.3,
    }  # fmt: skip
    return Diagnosis(**{**fields, **changes})
