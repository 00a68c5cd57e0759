# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure how near each convention comes to what a camera sees of real spectra.

    python scripts/studies/spectral_study.py [--data ../shared/data] [--cameras NAME]

Of all cameras of the Academy's rawtoaces-data under 31 lights: the angle between camera
RGB and truth, and CIEDE2000 of both rendered by the camera's own matrices, mean and
95th percentile over held-out reflectances, whose colour under D65 is the input."""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

import cg2raw  # noqa: E402
from cg2raw.profile.illuminant_spectra import illuminant_spectrum  # noqa: E402
from cg2raw.profile.spectral import profile_from_ssf  # noqa: E402
from cg2raw.profile.spectral_file import read_sensitivities  # noqa: E402
from oracles import adobe, spectral  # noqa: E402

LIGHTS = (
    *("A", "D50", "D55", "D65", "D75"),
    *(f"FL{number}" for number in range(1, 13)),
    *(f"LED-B{number}" for number in range(1, 6)),
    *("LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
    *(f"HP{number}" for number in range(1, 6)),
)
CONVENTIONS = ("paper", "sensor", "spectral")
METHODS = (*CONVENTIONS, "best 3x3")
SHOWN = {
    "600D": ("Canon_EOS_600D", ("A", "D65", "FL2", "FL11", "LED-B3")),
    "1Ds III": ("Canon_EOS-1Ds_Mark_III", ("A", "D65", "FL2", "FL11", "LED-B3")),
}
# Sensitivities do not tell these; they do not matter here.
BODY = {
    "cfa": "RGGB",
    "width": 64,
    "height": 64,
    "bits": 14,
    "black_level": 0,
    "white_level": 16383,
}


def held_out(charts):
    """Return reflectances (n, 81) that no fit has seen."""
    sets = spectral.held_out()
    return np.concatenate([sets[name] for name in charts])


def rendered(sensor, light, camera):
    """Return XYZ D50 (n, 3) that the sensor's matrices make of camera RGB (n, 3)."""
    transform = sensor.transform(light, "sensor")
    rgb = np.linalg.solve(transform.first, (camera / transform.gains).T).T
    to_xyz = spectral.colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
    return rgb @ to_xyz.T @ adobe.bradford(adobe.D50, adobe.D65).T


def seen(sensor, light, rgb, truth):
    """Return {method: camera RGB (n, 3)} of linear Rec.709 (n, 3)."""
    image = rgb.astype(np.float32)[None]
    found = {
        name: sensor.to_camera(
            image, illuminant=light, convention=name, highlights=False
        )[0].astype(np.float64)
        for name in CONVENTIONS
    }
    found["best 3x3"] = rgb @ np.linalg.lstsq(rgb, truth, rcond=None)[0]
    return found


def errors(sensor, rgb_of_camera, light, reflectances):
    """Return {method: (angles, CIEDE2000)} of one camera under one light."""
    response = illuminant_spectrum(light)[:, None] * rgb_of_camera
    gains = sensor.transform(light, "sensor").gains
    truth = reflectances @ response / response.sum(axis=0) * gains
    reference = rendered(sensor, light, truth)
    return {
        name: (
            spectral.degrees(truth, camera),
            spectral.difference(rendered(sensor, light, camera), reference),
        )
        for name, camera in seen(
            sensor, light, spectral.rec709_under_d65(reflectances), truth
        ).items()
    }


def study(path, reflectances):
    """Return {light: {method: (angles, CIEDE2000)}} of a camera's file."""
    measured = read_sensitivities(path)
    sensor = cg2raw.Sensor.from_json(json.dumps(profile_from_ssf(measured, **BODY)))
    return {
        light: errors(sensor, measured.rgb, light, reflectances) for light in LIGHTS
    }


def table(head, rows):
    """Print a table in Markdown."""
    print("| " + " | ".join(head) + " |")
    print("|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def cell(values):
    """Return mean and 95th percentile in words."""
    return f"{np.mean(values):.2f} {np.percentile(values, 95):.2f}"


def by_light(found):
    """Print mean and 95th percentile over cameras and objects, by light and method."""
    for number, what in enumerate(("degrees", "CIEDE2000")):
        print(f"## {what}: mean, 95th percentile, of {len(found)} cameras\n")
        rows = []
        for light in LIGHTS:
            of_light = [camera[light] for camera in found.values()]
            cells = [
                cell(np.concatenate([errors[name][number] for errors in of_light]))
                for name in METHODS
            ]
            rows.append([light, *cells])
        table(["light", *METHODS], rows)


def against_the_best_matrix(found):
    """Print spectral's mean angle over that of the best in-sample 3x3 matrix."""
    ratios = {
        (camera, light): of_light["spectral"][0].mean() / of_light["best 3x3"][0].mean()
        for camera, lights in found.items()
        for light, of_light in lights.items()
    }
    values = np.array(list(ratios.values()))
    worst = max(ratios, key=ratios.get)
    print("## spectral over the best 3x3 matrix, mean angles\n")
    print(
        f"mean {values.mean():.3f}, most {values.max():.3f} ({worst[0]}, {worst[1]}), "
        f"below 0.9 in {(values < 0.9).mean():.0%} of {len(values)} pairs\n"
    )


def shown(found):
    """Print the rows of docs/spectral.md."""
    rows = []
    for name, (camera, lights) in SHOWN.items():
        for light in lights if camera in found else ():
            of_light = found[camera][light]
            numbers = [
                of_light[m][0].mean() for m in ("sensor", "best 3x3", "spectral")
            ]
            rows.append([f"{name}, {light}", *(f"{value:.2f}" for value in numbers)])
    table(
        ["camera, light", "fitted to A and D65", "best 3x3, in-sample", "`spectral`"],
        rows,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared/data")
    parser.add_argument("--cameras", nargs="*", default=[], help="parts of file names")
    arguments = parser.parse_args()
    folder = arguments.data / "tables/ssf/rawtoaces-data/data/camera"
    files = {p.name.removesuffix("_380_780_5.json"): p for p in folder.glob("*.json")}
    wanted = {
        name: path
        for name, path in sorted(files.items())
        if not arguments.cameras or any(part in name for part in arguments.cameras)
    }
    if not wanted:
        sys.exit(f"spectral_study: no sensitivities of {arguments.cameras} in {folder}")
    reflectances = held_out(("CIE 224", "PMC"))
    found = {name: study(path, reflectances) for name, path in wanted.items()}
    shown(found)
    against_the_best_matrix(found)
    by_light(found)


if __name__ == "__main__":
    main()
