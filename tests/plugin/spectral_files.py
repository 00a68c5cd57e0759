# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral images that are written for tests, and what the plugin makes of them."""

from pathlib import Path

import colour
import numpy as np
import OpenImageIO as oiio

import cg2raw
from cg2raw.spectra import simulate_spectra
from images import attributes, read_dn
from python import commands

# colour-science's examples of the layout: a render by ART, reflectances.
FICHET = Path(colour.__file__).parent / "io" / "tests" / "resources"
CENTRES = np.arange(380.0, 781.0, 12.5)
WHITE = 400000.0  # cd/m2; what the spectra below reach
ASKED = {"sensor": "canon-600d", "illuminant": "FL2", "white_luminance": WHITE}


def name_of(nm):
    return "S0." + f"{nm:.1f}nm".replace(".", ",")


def write_spectra(path, pixels, names, kind="float", said=(), tile=0):
    """Write (H, W, N) pixels with named channels; return the path."""
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    spec.channelnames = tuple(names)
    spec.tile_width = spec.tile_height = tile
    for name, value in said:
        spec.attribute(name, value)
    image = oiio.ImageOutput.create(str(path))
    assert image.open(str(path), spec), image.geterror()
    assert image.write_image(np.ascontiguousarray(pixels, np.float32))
    image.close()
    return path


def random_spectra():
    """Return (40, 56, N) spectra: smooth ones, and lines."""
    rng = np.random.default_rng(8)
    smooth = rng.random((40, 56, 6)) @ rng.random((6, len(CENTRES)))
    lines = (rng.random((40, 56, len(CENTRES))) > 0.97) * 8.0
    return (smooth + lines).astype(np.float32)


def expected(spectra, centres=CENTRES, **run):
    return simulate_spectra(
        cg2raw.Sensor("canon-600d"),
        spectra,
        centres,
        illuminant="FL2",
        white=WHITE,
        **run,
    )


def check_command(oiiotool, path, folder):
    """Assert that plugin and command write the same bytes; return the DN."""
    oiiotool(path, *attributes(**ASKED), "-o", folder / "a.dng")
    words = ["--sensor", "canon-600d", "--illuminant", "FL2"]
    words += ["--white-luminance", WHITE]
    done = commands.run("convert", path, "-o", folder / "b.dng", *words)
    assert done.code == 0, done.err
    assert (folder / "a.dng").read_bytes() == (folder / "b.dng").read_bytes()
    return read_dn(folder / "a.dng")
