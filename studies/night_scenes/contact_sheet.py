# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A picture of a folder's frames for the documentation. Needs cg2raw and Pillow."""

from pathlib import Path

import numpy as np

from .folder import Refused
from .statistics import frames

COLUMNS, TILE, GAP = 8, (240, 135), 4  # tiles a row, one a layout; pixels
EXPOSURE = 1.6  # scene linear that is shown as white is about 1 / this, softly


def tone(pixels):
    """Return (H, W, 3) uint8 sRGB of scene-linear pixels, highlights rolled off."""
    x = np.maximum(pixels, 0) * EXPOSURE
    x = x * (1 + x / 16) / (1 + x)  # Reinhard et al., SIGGRAPH 2002, white at 4
    x = np.clip(1.25 * x, 0, 1)
    curve = np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255 * np.clip(curve, 0, 1)).astype(np.uint8)


def write(folder, path):
    """Write all frames of @folder side by side to @path, by kind and index."""
    from PIL import Image

    order = ("street", "square", "waterfront", "interior")
    shown = []
    for index, pixels, described in frames(folder):
        kind = described.get("scene", {}).get("kind", order[0])
        tile = Image.fromarray(tone(pixels)).resize(TILE, Image.Resampling.LANCZOS)
        shown.append((order.index(kind), index, tile))
    shown.sort(key=lambda each: each[:2])
    if Path(path).suffix.lower() not in (".png", ".jpg"):
        raise Refused(f"{path}: must end in .png or .jpg")
    rows = -(-len(shown) // COLUMNS)
    wide, tall = TILE[0] + GAP, TILE[1] + GAP
    sheet = Image.new("RGB", (COLUMNS * wide - GAP, rows * tall - GAP), "white")
    for place, (_, _, tile) in enumerate(shown):
        sheet.paste(tile, (place % COLUMNS * wide, place // COLUMNS * tall))
    sheet.save(path, quality=85)
