# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draw a ColorChecker under a fluorescent lamp: spectra, matrices, convention spectral.

    ./studies/run spectral-figure OUT.png [--sensor ID] [--light FL2]

Each DNG is rendered by LibRaw. The chart's spectra are those of ISO 17321-1, as
colour-science has them; the RGB is their colour under D65."""

import argparse
import tempfile
from pathlib import Path

import numpy as np
import rawpy
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import cg2raw
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from cg2raw.spectra import simulate_spectra
from oracles import spectral

SIDE = 60  # pixels of a patch
STEP = WAVELENGTHS[1] - WAVELENGTHS[0]
GAIN = 4  # of the maps of differences


def chart_of(patches):
    """Return the (H, W, n) float32 image of 24 patches (24, n)."""
    rows = patches.reshape(4, 6, -1)
    return rows.repeat(SIDE, axis=0).repeat(SIDE, axis=1).astype(np.float32)


def rendered(frame, folder):
    """Return LibRaw's (H, W, 3) uint8 sRGB of a RAW frame."""
    path = Path(folder) / "chart.dng"
    cg2raw.write_dng(path, frame)
    with rawpy.imread(str(path)) as raw:
        return raw.postprocess(use_camera_wb=True, no_auto_bright=True)


def white_luminance(light):
    """Return cd/m2 of the light's spectrum in W/(m2 sr nm), which RGB calls 1."""
    return 683.0 * STEP * (illuminant_spectrum(light) @ spectral.observer()[:, 1])


def pictures(id, light, folder):
    """Return {title: (H, W, 3) uint8} of the chart, the spectral one first."""
    sensor, power = cg2raw.Sensor(id), illuminant_spectrum(light)
    patches = spectral.held_out()["ColorChecker"]
    radiance = chart_of(patches * power)
    frames = {
        "spectral image": simulate_spectra(
            sensor,
            radiance,
            WAVELENGTHS,
            illuminant=light,
            white=white_luminance(light),
        )
    }
    for convention in ("sensor", "spectral"):
        frames[f"RGB, convention {convention}"] = sensor.simulate(
            chart_of(spectral.rec709_under_d65(patches)),
            illuminant=light,
            convention=convention,
        )
    return {title: rendered(frame, folder) for title, frame in frames.items()}


def difference(picture, truth, block=1):
    """Return (h, w, 3) float: between means of block x block pixels, of 255."""
    error = picture.astype(np.float64) - truth
    height, width = (side // block for side in error.shape[:2])
    blocks = error.reshape(height, block, width, block, 3)
    return np.abs(blocks.mean(axis=(1, 3)))


def draw(found, title, again=None, block=1):
    """Return the figure: pictures above, their differences from the first below.

    again : the first with other noise, which is what is below itself. block : pixels
    whose mean is compared, height and width."""
    figure = Figure(
        figsize=(5.0 + 2.0 * len(found), 5.2), dpi=100, layout="constrained"
    )
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, len(found))
    truth = next(iter(found.values()))
    for (name, picture), above, below in zip(found.items(), *axes, strict=True):
        is_first = above is axes[0, 0]
        other = again if is_first and again is not None else picture
        error = difference(other, truth, block)
        above.imshow(picture, interpolation="nearest")
        above.set_title(name, fontsize=11)
        below.imshow(np.clip(GAIN * error, 0, 255).astype(np.uint8))
        below.set_title(f"difference x {GAIN}, mean {error.mean():.1f}", fontsize=10)
        for panel in (above, below):
            panel.set_axis_off()
    figure.suptitle(title, fontsize=12)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", metavar="OUT.png")
    parser.add_argument("--sensor", default="canon-600d")
    parser.add_argument("--light", default="FL2")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = pictures(arguments.sensor, arguments.light, folder)
    title = f"{arguments.sensor} under {arguments.light}, rendered by LibRaw"
    figure = draw(found, title)
    figure.savefig(arguments.out, metadata={"Software": None})


if __name__ == "__main__":
    main()
