# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Develop a DNG with LibRaw, as a photographer's program would.

    python scripts/develop.py IN.dng OUT.png

Prints what LibRaw read in the file, and writes a picture of half its size under the
file's own white balance, without automatic brightness.
"""

import sys

import OpenImageIO
import rawpy


def describe(raw):
    """Return one line on what LibRaw knows of the open file @raw."""
    sizes = raw.sizes
    pattern = "".join(chr(raw.color_desc[i]) for i in raw.raw_pattern.flat)
    balance = raw.camera_whitebalance
    neutral = ", ".join(f"{balance[1] / gain:.4f}" for gain in balance[:3])
    return (
        f"{sizes.width}x{sizes.height}, pattern {pattern}, black "
        f"{raw.black_level_per_channel[0]}, white {raw.white_level}, "
        f"neutral ({neutral})"
    )


def write_png(path, pixels):
    """Write 8-bit RGB @pixels to @path."""
    height, width, channels = pixels.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, "uint8")
    image = OpenImageIO.ImageBuf(spec)
    image.set_pixels(OpenImageIO.ROI(), pixels)
    if not image.write(path):
        sys.exit(image.geterror())


def main(source, target):
    """Develop @source into @target."""
    with rawpy.imread(source) as raw:
        print(f"LibRaw: {source}: {describe(raw)}")
        write_png(
            target,
            raw.postprocess(use_camera_wb=True, half_size=True, no_auto_bright=True),
        )


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
