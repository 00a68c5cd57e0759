# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Who else writes a mosaic into a file: tifffile, and PiDNG (MIT) if it is installed.

PiDNG is no dependency: `pip install --no-deps pidng` in .venv adds its rows."""

import numpy as np
import tifffile


def ours(raw, path, compression):
    """Return what writes a DNG by cg2raw on one thread."""
    import cg2raw

    return lambda: cg2raw.write_dng(
        path, raw, compression=compression, threads=1, preview=False, sync=False
    )


def pidng(raw, folder, compress):
    """Return what writes a DNG by PiDNG, or None where it is not installed."""
    try:
        from pidng.core import RAW2DNG, DNGTags, Tag
    except ImportError:
        return None
    tags = DNGTags()
    height, width = raw.shape
    tags.set(Tag.ImageWidth, width)
    tags.set(Tag.ImageLength, height)
    tags.set(Tag.TileWidth, width)
    tags.set(Tag.TileLength, height)
    tags.set(Tag.BitsPerSample, 16)
    tags.set(Tag.PhotometricInterpretation, 32803)  # CFA
    tags.set(Tag.CFARepeatPatternDim, [2, 2])
    tags.set(Tag.CFAPattern, [0, 1, 1, 2])
    writer = RAW2DNG()
    writer.options(tags, path=f"{folder}/", compress=compress)
    return lambda: writer.convert(raw, filename=f"pidng{int(compress)}")


def writers(raw, folder):
    """Return {name: (function, path)} of all that write a mosaic, (H, W) uint16."""
    plain = np.asarray(raw)
    paths = {name: folder / f"{name}.dng" for name in ("none", "ljpeg", "ljpeg-2d")}
    tiff = folder / "peer.tif"
    found = {"tifffile (peer)": (lambda: tifffile.imwrite(tiff, plain), tiff)}
    for name, path in paths.items():
        found[f"cg2raw, {name}"] = ours(raw, path, name), path
    for name, compress in (("none", False), ("ljpeg", True)):
        write = pidng(plain, folder, compress)
        if write is None:
            print("PiDNG is not installed: no rows of it (pip install --no-deps pidng)")
            break
        try:
            write()
        except SystemError as error:  # 4.0.9's compiled part, from Python 3.10 on
            print(f"PiDNG, {name}: no row, it fails in this Python: {error}")
            continue
        found[f"PiDNG, {name}"] = write, folder / f"pidng{int(compress)}.dng"
    return found
