# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Published noise calibrations as rows of a profile, in x = 0..1 above black."""

import json
import math

from scipy.stats import tukeylambda

from .tables import rows_of


def significant(value, digits=6):
    """Return a number rounded to so many significant digits."""
    return float(f"{value:.{digits}g}")


def samsung_noise(tables, model, black, white):
    """Return rows of var = b1 DN + b2 with DN including black, one per CFA site.

    In x = (DN - black) / (white - black): beta1 = b1 / (white - black) and
    beta2 = max(0, b1 black + b2) / (white - black)^2."""
    span = white - black
    path = tables / "noise" / "samsung_pixel_model_params.csv"
    rows = [row for row in rows_of(path) if row["model"] == model]
    noise = {}
    for row in sorted(
        rows, key=lambda r: (int(r["iso"]), int(r["bayer_pos_00_01_10_11"]))
    ):
        b1, b2 = float(row["beta1_DN"]), float(row["beta2_DN2"])
        at = noise.setdefault(int(row["iso"]), {"beta1": [], "beta2": []})
        at["beta1"].append(significant(b1 / span))
        at["beta2"].append(significant(max(0.0, b1 * black + b2) / span**2))
    return [{"iso": iso, **values} for iso, values in noise.items()]


# Kmin is of ISO 100, Kmax of ISO 6400. Source: the authors, in the tracker of
# Vandermode/ELD, "Relationship between K and ISO".
ELD_FIRST_ISO, ELD_STOPS = 100, 6


def eld_at(camera, profile, stop):
    """Return K, Gaussian sd, Tukey-lambda sd, row sd (DN of 14 bits) and lambda.

    Each scale follows log sigma = slope log K + bias, with natural logarithms
    (Wei et al., CVPR 2020, section 4). `G_shape` holds lambda twice per full stop from
    ISO 100: 16 values reach ISO 12800, 18 reach 25600. With these readings the two fits
    of one read noise, Gaussian and Tukey-lambda, agree within 13 % on average for each
    camera and within 25 % at worst."""
    gain = camera["Kmin"] * (camera["Kmax"] / camera["Kmin"]) ** (stop / ELD_STOPS)
    shape = sum(camera["G_shape"][2 * stop : 2 * stop + 2]) / 2
    gaussian, tukey, row = (
        math.exp(
            camera[profile][k]["slope"] * math.log(gain) + camera[profile][k]["bias"]
        )
        for k in ("g_scale", "G_scale", "R_scale")
    )
    return gain, gaussian, tukey * math.sqrt(tukeylambda.var(shape)), row, shape


def eld_disagreement(camera, profile, stop):
    """Return |log| of the ratio of the two published fits of one read noise."""
    _, gaussian, tukey, _, _ = eld_at(camera, profile, stop)
    return abs(math.log(tukey / gaussian))


def eld_noise(tables, name, black, white):
    """Return noise rows of a camera of Wei et al. (CVPR 2020), ISO 100 to 6400.

    beta1 = K / span; beta2 = (read variance + row variance) / span^2. A camera that
    was calibrated twice takes at each ISO the calibration whose Gaussian and
    Tukey-lambda fits of the same read noise agree better."""
    path = tables / "noise" / "eld_camera_params.json"
    camera = json.loads(path.read_text())[name]
    profiles = sorted(key for key in camera if key.startswith("Profile-"))
    span = white - black
    rows = []
    for stop in range(ELD_STOPS + 1):
        best = min(profiles, key=lambda key: eld_disagreement(camera, key, stop))
        gain, _, read, row, shape = eld_at(camera, best, stop)
        rows.append(
            {
                "iso": ELD_FIRST_ISO * 2**stop,
                "beta1": [significant(gain / span)] * 4,
                "beta2": [significant((read**2 + row**2) / span**2)] * 4,
                "tukey_lambda": significant(shape),
                "row_sigma": significant(row / span),
            }
        )
    return rows
