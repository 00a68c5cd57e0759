# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure the profiles made of spectral sensitivities; print docs/spectral.md's tables.

    ./studies/run ssf-report [--data ../shared/data]

Against: the ColorMatrices that Adobe publishes, the fit of rawtoaces, and neutrals of
photographed grey cards."""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

from cg2raw.profile.illuminant_spectra import REAL_LIGHTS
from cg2raw.profile.matrix_fit import balanced_camera
from cg2raw.profile.spectral import color_matrices, neutral_under
from cg2raw.profile.spectral_file import read_sensitivities
from oracles import adobe, spectral
from studies.places import ROOT

# Camera: file of sensitivities, model of the published matrices, camera of the NUS set.
PUBLISHED = {
    "Canon EOS-1Ds Mark III": (
        "Canon_EOS-1Ds_Mark_III_380_780_5.json",
        "EOS-1Ds Mark III",
        "Canon1DsMkIII",
    ),
    "Canon EOS 600D": ("Canon_EOS_600D_380_780_5.json", "EOS 600D", "Canon600D"),
}
LIGHTS = ("A", "D65", "D50", "FL2", "FL11", "LED-B3", "HP2")


def table(head, rows):
    """Print a table in Markdown."""
    print("| " + " | ".join(head) + " |")
    print("|" + " --- |" * len(head))
    for row in rows:
        cells = [f"{c:.2f}" if isinstance(c, float) else str(c) for c in row]
        print("| " + " | ".join(cells) + " |")
    print()


def fitted_camera(measured):
    """Return the adobe.Camera with the matrices fitted to sensitivities."""
    matrices = color_matrices(measured)
    return adobe.Camera([2850.0, 6500.0], [matrices["A"], matrices["D65"]])


def chart_errors(measured, ours, published, name):
    """Return mean CIEDE2000 of the ColorChecker: ours, published, one to the other."""
    power, patches = spectral.light(name), spectral.held_out()["ColorChecker"]
    truth = spectral.truth_d50(power, patches)
    rendered = [
        spectral.xyz_d50_from_raw(camera, measured.rgb, power, patches)
        for camera in (ours, published)
    ]
    return [
        float(spectral.difference(*pair).mean())
        for pair in ((rendered[0], truth), (rendered[1], truth), rendered)
    ]


def against_published(tables, folder):
    """Print both cameras' renderings and neutrals beside those of Adobe's matrices."""
    errors, neutrals = [], []
    for camera, (file, model, _) in PUBLISHED.items():
        measured = read_sensitivities(folder / file)
        published = spectral.published_camera(
            tables / "matrices/rawler_color_matrices.csv", model
        )
        ours = fitted_camera(measured)
        for name in LIGHTS:
            found = chart_errors(measured, ours, published, name)
            errors.append([camera, name, *found])
        for name, xy in (("A", (0.4476, 0.4074)), ("D65", adobe.D65)):
            seen = [neutral_under(measured, name)]
            seen += [c.neutral_from_xy(xy) for c in (ours, published)]
            cells = [f"{n[0]:.4f} {n[2]:.4f}" for n in seen]
            neutrals.append([camera, name, *cells])
    head = ["camera", "light", "fitted", "Adobe's", "one to the other"]
    table(head, errors)
    head = ["camera", "light", "sensitivities", "fitted matrix", "Adobe's matrix"]
    table(head, neutrals)


def held_out_errors(measured, camera):
    """Return {light: (ours, rawtoaces)}: mean CIEDE2000 over all held-out objects."""
    objects = np.concatenate(list(spectral.held_out().values()))
    errors = {}
    for name in ("A", "D65"):
        power = spectral.light(name)
        truth = spectral.truth_d50(power, objects)
        ours = spectral.xyz_d50_from_raw(camera, measured.rgb, power, objects)
        matrix = spectral.rawtoaces_xyz_d50_from_balanced(measured.rgb, power)
        theirs = balanced_camera(measured.rgb, power, objects) @ matrix.T
        errors[name] = [
            float(spectral.difference(x, truth).mean()) for x in (ours, theirs)
        ]
    return errors


def against_rawtoaces(folder):
    """Print the distribution of errors of all cameras, and how often each fit wins."""
    files = sorted(folder.glob("*.json"))
    found = []
    for file in files:
        measured = read_sensitivities(file)
        found.append(held_out_errors(measured, fitted_camera(measured)))
    rows = []
    for name in ("A", "D65"):
        errors = np.array([camera[name] for camera in found])
        for fit, column in (("fitted", 0), ("rawtoaces", 1)):
            better = int(np.sum(errors[:, column] < errors[:, 1 - column]))
            quartiles = np.percentile(errors[:, column], [0, 25, 50, 75, 100])
            rows.append([name, fit, *map(float, quartiles), f"{better}/{len(files)}"])
    head = ["light", "fit", "least", "quartile", "median", "quartile", "most", "better"]
    table(head, rows)


def neutrals_of(path, camera):
    """Return (n, 2) grey cards' (R/G, B/G) of one camera."""
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["camera"] == camera]
    rgb = np.array([[float(row[c]) for c in "rgb"] for row in rows])
    return rgb[:, [0, 2]] / rgb[:, 1:2]


def against_grey_cards(tables, folder):
    """Print photographed neutrals beside those of REAL_LIGHTS."""
    rows = []
    for camera, (file, _, name) in PUBLISHED.items():
        measured = read_sensitivities(folder / file)
        lights = np.array([neutral_under(measured, light) for light in REAL_LIGHTS])
        ours = lights[:, [0, 2]]
        cards = neutrals_of(tables / "illuminants/nus9_gt_illuminants.csv", name)
        inside = np.mean(Delaunay(ours).find_simplex(cards) >= 0)
        for what, points in (("grey cards", cards), ("lights", ours)):
            mean, sd = points.mean(axis=0), points.std(axis=0, ddof=1)
            rows.append(
                [
                    camera,
                    f"{len(points)} {what}",
                    f"{mean[0]:.3f} {mean[1]:.3f}",
                    f"{sd[0]:.3f} {sd[1]:.3f}",
                    f"{100 * inside:.0f} %" if what == "grey cards" else "",
                ]
            )
    table(["camera", "neutrals", "mean", "sd", "inside the lights' hull"], rows)


def main():
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    tables = parser.parse_args().data / "tables"
    folder = tables / "ssf/rawtoaces-data/data/camera"
    if not folder.is_dir():
        sys.exit(f"ssf-report: no folder {folder}; --data names another one")
    against_published(tables, folder)
    against_rawtoaces(folder)
    against_grey_cards(tables, folder)


if __name__ == "__main__":
    main()
