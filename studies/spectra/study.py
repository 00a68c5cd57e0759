# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Print how near each convention comes to what a camera sees of real spectra.

    ./studies/run spectra [--reflectances FILE ...] [--jobs 2]

Of all cameras of the Academy's rawtoaces-data under 34 lights: the angle between camera
RGB and truth, and CIEDE2000 of both rendered by the camera's own matrices, mean and
95th percentile over held-out reflectances, whose colour under D65 is the input. The
same input prints the same tables; docs/spectral-evidence.md has them."""

import argparse
import sys
from pathlib import Path

import numpy as np

from studies.places import ROOT
from studies.spectra.data import (
    CAMERAS,
    MONOCHROMATIC,
    camera_files,
    distance,
    reflectance_sets,
    training_reflectances,
)
from studies.spectra.errors import METHODS, measure

MEASURES = {"degrees": "degrees", "difference": "CIEDE2000"}
SHOWN = {"600D": "Canon_EOS_600D", "1Ds III": "Canon_EOS-1Ds_Mark_III"}
SHOWN_LIGHTS = ("A", "D65", "FL2", "FL11", "LED-B3")


def table(head, rows):
    """Print a table in Markdown: text to the left, numbers to the right."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    print("\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n")


def cell(values):
    """Return mean and 95th percentile in words."""
    if np.isnan(values).all():
        return "-"
    return (
        f"{np.nanmean(values, dtype=np.float64):.2f} {np.nanpercentile(values, 95):.2f}"
    )


def columns(errors):
    """Return the lights, as indices, but for those of one line."""
    return [i for i, light in enumerate(errors.lights) if light != MONOCHROMATIC]


def by_set(errors, sets, left_out):
    """Print what each set holds, and how far its reflectances are from the training."""
    training = np.array(training_reflectances())
    rows = [
        [
            *(name, str(len(sets[name]))),
            *map(str, out.values()),
            f"{distance(sets[name], training).min():.3f}",
        ]
        for name, out in left_out.items()
    ]
    head = [
        "reflectances",
        "used",
        "black",
        "twice",
        "of the training",
        "nearest to it",
    ]
    print("## Reflectances\n")
    table(head, rows)


def summary(errors):
    """Print mean and 95th percentile over all cameras and lights but sodium, by set."""
    kept = columns(errors)
    for kind, name in MEASURES.items():
        print(f"## {name}: mean, 95th percentile, of all cameras and lights but LPS\n")
        values = getattr(errors, kind)[:, kept]
        rows = [
            [which, *(cell(values[:, :, m, part]) for m in range(len(METHODS)))]
            for which, part in errors.sets.items()
        ]
        table(["reflectances", *METHODS], rows)


def ratio_row(errors, which, method):
    """Return the cells of spectral's ratios to a method, over a set."""
    kept = columns(errors)
    ratio = errors.ratio(which, method)[:, kept]
    camera, light = np.unravel_index(ratio.argmax(), ratio.shape)
    worst = f"{errors.cameras[camera]}, {errors.lights[kept[light]]}"
    return [
        *(f"{which}: {method}", f"{ratio.mean():.3f}", f"{ratio.max():.3f}", worst),
        *(f"{(ratio < limit).mean():.0%}" for limit in (0.9, 1.0)),
    ]


def ratios(errors):
    """Print spectral's mean angle over those of matrices, by set."""
    pairs = len(errors.cameras) * len(columns(errors))
    print(f"## Mean angle of `spectral` over that of a matrix, {pairs} pairs\n")
    head = ["reflectances: matrix", "mean", "most", "of", "below 0.9", "below 1"]
    rows = [
        ratio_row(errors, which, method)
        for which in errors.sets
        for method in METHODS[1:-1]
    ]
    table(head, rows)


def by_light(errors):
    """Print mean and 95th percentile over cameras and reflectances, by light."""
    for which, part in errors.sets.items():
        for kind, name in MEASURES.items():
            print(f"## {which}, {name}: mean, 95th percentile\n")
            values = getattr(errors, kind)[..., part]
            rows = [
                [light, *(cell(values[:, i, m]) for m in range(len(METHODS)))]
                for i, light in enumerate(errors.lights)
            ]
            table(["light", *METHODS], rows)


def shown(errors, which="CIE 224, PMC"):
    """Print mean angles of two cameras under some lights."""
    mean = errors.mean(which)
    rows = [
        [
            f"{name}, {light}",
            *(
                f"{value:.2f}"
                for value in mean[
                    errors.cameras.index(camera), errors.lights.index(light)
                ]
            ),
        ]
        for name, camera in SHOWN.items()
        if camera in errors.cameras
        for light in SHOWN_LIGHTS
    ]
    print(f"## Two cameras, mean degrees, {which}\n")
    table(["camera, light", *METHODS], rows)


def arguments():
    """Return the command line."""
    parser = argparse.ArgumentParser(
        prog="spectral_study", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared/data")
    parser.add_argument("--cameras", nargs="*", default=[], help="parts of file names")
    parser.add_argument(
        "--reflectances",
        nargs="*",
        default=[],
        metavar="FILE",
        help="more sets: CSV, .dat or .npz; docs/spectral-evidence.md says how",
    )
    parser.add_argument("--jobs", type=int, default=1, help="cameras at a time")
    parser.add_argument("--plot", metavar="OUT.png", help="draw the last set by light")
    parser.add_argument("--ratios", metavar="OUT.png", help="draw its ratios")
    return parser.parse_args()


def main():
    """Run the command; one line on stderr and exit 1 for a file that is no good."""
    given = arguments()
    files = camera_files(given.data, given.cameras)
    if not files:
        folder = given.data / CAMERAS
        sys.exit(f"spectra: no sensitivities of {given.cameras} in {folder}")
    try:
        sets, left_out = reflectance_sets(given.reflectances)
    except ValueError as error:
        sys.exit(f"spectra: {error}")
    errors = measure(files, sets, given.jobs)
    print(f"{len(files)} cameras, {len(errors.lights)} lights\n")
    by_set(errors, sets, left_out)
    ratios(errors)
    summary(errors)
    shown(errors)
    by_light(errors)
    if given.plot or given.ratios:
        from studies.spectra.plots import draw

        draw(errors, list(sets)[-1], given.plot, given.ratios)


if __name__ == "__main__":
    main()
