# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The judge's frames as a camera's files are developed: a picture, and their grain."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from studies.cameras import Camera
from studies.mitsuba_judge.folder import judge_frames
from studies.protocol import PROTOCOL
from studies.tasks.isp import difference, pairs

COLUMNS, GAP = 8, 2  # frames a row; pixels between


def developed(folder: Path, camera: Camera, count: int | None = None) -> Any:
    """Return pictures (n, H, W, 3), 0..1, of a folder's first frames, as in study 3."""
    frames = judge_frames(folder, camera.id)
    kept = replace(
        frames, images=frames.images[:count], neutrals=frames.neutrals[:count]
    )
    return pairs(kept, camera.sensor, replace(PROTOCOL.isp, step=1)).pictures


def contact_sheet(folder: Path, camera: Camera, path: Path) -> None:
    """Write all frames of a folder side by side. Raises ValueError, OSError."""
    from PIL import Image

    if path.suffix.lower() not in (".png", ".jpg"):
        raise ValueError(f"{path}: must end in .png or .jpg")
    pictures = np.round(255.0 * developed(folder, camera)).astype(np.uint8)
    height, width = pictures.shape[1] + GAP, pictures.shape[2] + GAP
    rows = -(-len(pictures) // COLUMNS)
    size = COLUMNS * width - GAP, rows * height - GAP
    sheet = Image.new("RGB", size, "white")
    for number, picture in enumerate(pictures):
        row, column = divmod(number, COLUMNS)
        sheet.paste(Image.fromarray(picture), (column * width, row * height))
    sheet.save(path, quality=88)


def grain(folder: Path, again: Path, camera: Camera, count: int) -> list[float]:
    """Return each first frame's mean CIEDE2000 from another draw of its paths."""
    one, other = (developed(place, camera, count) for place in (folder, again))
    return [
        float(np.mean(difference(a[None], b[None])))
        for a, b in zip(one, other, strict=True)
    ]
