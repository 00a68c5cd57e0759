# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of patch means on disk: a chart whose colours are not quite as published."""

import numpy as np

import cg2raw
from cg2raw.diagnose.captures.chart import (
    COLORCHECKER,
    COLORCHECKER_NAMES,
    rec709_from_xyz,
    xyz_from_lab,
)
from cg2raw.diagnose.captures.chart_table import places_of

SENSOR = cg2raw.Sensor("canon-5d-mark-iv")
SPAN = SENSOR.white_level - SENSOR.black_level[0]
SIDE = 20  # px of one site along a patch
COLOR_ERROR = 0.01  # relative, of each patch and channel, in all frames of the chart
NOMINAL = np.maximum(rec709_from_xyz(xyz_from_lab(COLORCHECKER)), 0)


def shot(rgb, frame):
    """Return (24, 4) means at R, G1, G2 and B of patches that were simulated."""
    picture = np.kron(rgb.reshape(4, 6, 3), np.ones((2 * SIDE, 2 * SIDE, 1)))
    run = {"illuminant": "D65", "iso": 100, "frame": frame, "highlights": False}
    raw = np.asarray(SENSOR.simulate(picture.astype(np.float32), **run), float)
    blocks = raw.reshape(4, SIDE, 2, 6, SIDE, 2).mean((1, 4)).transpose(0, 2, 1, 3)
    return blocks.reshape(24, 4)[:, list(places_of(SENSOR.cfa))]


def write_tables(folder, offset=0.0, threshold=0.0, seed=1, frames=9, more=()):
    """Write tables of one chart in lights of any brightness; return the manifest.

    offset : of white, that black lies too high. threshold : of white, below which means
    are left out. more : lines of other frames."""
    rng = np.random.default_rng(seed)
    chart = NOMINAL * (1 + COLOR_ERROR * rng.standard_normal(NOMINAL.shape))
    lines = list(more)
    for index in range(frames):
        brightness = rng.uniform(0.3, 0.75)
        means = shot(chart * brightness, 100 * seed + index) + offset * SPAN
        rows = [
            ",".join(
                "" if mean < SENSOR.black_level[0] + threshold * SPAN else f"{mean:.3f}"
                for mean in row
            )
            for row in means
        ]
        pairs = zip(COLORCHECKER_NAMES, rows, strict=True)
        text = "".join(f"{name},{row},{SIDE**2}\n" for name, row in pairs)
        (folder / f"{index}.csv").write_text(f"patch,R,G1,G2,B,count\n{text}")
        lines.append(f"{{file: {index}.csv, kind: chart, chart: colours.csv}}")
    pairs = zip(COLORCHECKER_NAMES, NOMINAL, strict=True)
    text = "".join(f"{name},{r:.6f},{g:.6f},{b:.6f}\n" for name, (r, g, b) in pairs)
    (folder / "colours.csv").write_text(f"patch,r,g,b\n{text}")
    top = f"sensor: {SENSOR.id}\niso: 100\nilluminant: D65\nframes:\n"
    path = folder / "captures.yaml"
    path.write_text(top + "".join(f"  - {line}\n" for line in lines))
    return path
