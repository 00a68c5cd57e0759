# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Images to write, and ways to read back, for the tests of the plugin."""

import numpy as np
import OpenImageIO as oiio
import rawpy

# What asks our reader for a picture, before the name of a DNG.
DEVELOPED = ("-iconfig", "dng:developed", 1)


def write_image(path, pixels, attributes=None, tile=0, typed=()):
    """Write (H, W, C) pixels as float32 and return the path; tiled if tile is not 0."""
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "float")
    spec.tile_width = spec.tile_height = tile
    for name, value in (attributes or {}).items():
        spec.attribute(name, value)
    for name, kind, value in typed:
        spec.attribute(name, kind, value)
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels, dtype=np.float32))
    if tile:
        image.set_write_tiles(tile, tile)
    assert image.write(str(path)), image.geterror()
    return path


def read_dn(path):
    """Return the (H, W) uint16 mosaic of a DNG, as LibRaw reads it."""
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image_visible.copy()


def attributes(**values):
    """Return oiiotool arguments: sensor="x" -> --attrib dng:sensor x."""
    arguments = []
    for name, value in values.items():
        arguments += ["--attrib", f"dng:{name}", value]
    return arguments


def said_of(oiiotool, path, *hints):
    """Return {name: text} of what oiiotool --info -v prints."""
    lines = oiiotool(*hints, "--info", "-v", path).stdout.splitlines()
    pairs = [line.strip().split(": ", 1) for line in lines[1:] if ": " in line]
    return {"": lines[1], **{name: value.strip('"') for name, value in pairs}}


def numbers(text):
    """Return the numbers of an attribute."""
    return [float(word) for word in text.split(",")]
