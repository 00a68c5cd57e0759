# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Draw one scene rendered by Mitsuba in spectra, and in RGB with each convention.

    python -m pip install mitsuba
    ./studies/run mitsuba-figure OUT.png [--light FL2] [--samples 1024]

The spectral render under the lamp goes through the sensor's sensitivities; the RGB one
has the colours of the same reflectances under D65 and a white lamp. Each DNG is
rendered by LibRaw. A second spectral render of another seed says what is noise."""

import argparse
import sys
import tempfile

import cg2raw
from cg2raw.spectra import simulate_spectra
from studies.spectra.figure import difference, draw, rendered, white_luminance
from studies.spectra.mitsuba_scene import (
    CENTRES,
    Rec709,
    Spectra,
    render,
)

BLOCK = 4  # pixels' side, whose means are compared: less of it is noise
CONVENTIONS = ("dng", "paper", "spectral")


def pictures(mi, given, folder):
    """Return {title: (H, W, 3) uint8}, the spectral one first, and one of another."""
    sensor, light = cg2raw.Sensor(given.sensor), given.light

    def of_spectra(seed):
        spectra = render(mi, Spectra(light), given.samples, seed)
        white = white_luminance(light)
        frame = simulate_spectra(
            sensor, spectra, CENTRES, illuminant=light, white=white
        )
        return rendered(frame, folder)

    found = {"spectral render": of_spectra(0)}
    rgb = render(mi, Rec709(light), given.samples, 2)
    for convention in CONVENTIONS:
        frame = sensor.simulate(rgb, illuminant=light, convention=convention)
        found[f"RGB, convention {convention}"] = rendered(frame, folder)
    return found, of_spectra(1)


def main():
    """Run the command; one line on stderr and exit 1 without Mitsuba."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", metavar="OUT.png")
    parser.add_argument("--sensor", default="canon-600d")
    parser.add_argument("--light", default="FL2")
    parser.add_argument("--samples", type=int, default=1024, help="per pixel")
    given = parser.parse_args()
    try:
        import mitsuba as mi
    except ImportError:
        sys.exit("mitsuba-figure: needs Mitsuba 3: python -m pip install mitsuba")
    with tempfile.TemporaryDirectory() as folder:
        found, again = pictures(mi, given, folder)
    title = f"{given.sensor} under {given.light}, {given.samples} samples a pixel"
    figure = draw(found, f"{title}, rendered by LibRaw", again, BLOCK)
    small = {"metadata": {"Software": None}, "pil_kwargs": {"optimize": True}}
    figure.savefig(given.out, **small)
    truth = next(iter(found.values()))
    for name, picture in {**found, "spectral render, another seed": again}.items():
        mean = difference(picture, truth, BLOCK).mean()
        print(f"{name}: mean difference {mean:.2f} of 255")


if __name__ == "__main__":
    main()
