# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A photographed chart as a scene: patches of known colour; their middles count."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.diagnose.captures.manifest_charts import Patch

MIDDLE = 0.6  # of a patch's sides that counts: edges are blurred, and have glare
# A patch of the ColorChecker Classic is 40 mm wide, from centre to centre it is 46 mm.
# Source: measured on the chart; a few mm are of no importance to the middle.
PATCH_OVER_PITCH = 0.85
GRID = (4, 6)  # rows and columns of the ColorChecker Classic
ROWS = 256  # that are drawn at a time
D50 = (0.3457 / 0.3585, 1.0, 0.2958 / 0.3585)  # XYZ. Source: DNG 1.7.1, chapter 6
COLORCHECKER_NAMES = (
    *("dark skin", "light skin", "blue sky", "foliage", "blue flower", "bluish green"),
    *("orange", "purplish blue", "moderate red", "purple", "yellow green"),
    *("orange yellow", "blue", "green", "red", "yellow", "magenta", "cyan"),
    *("white", "neutral 8", "neutral 6.5", "neutral 5", "neutral 3.5", "black"),
)
# ColorChecker Classic, CIE L*a*b* under D50, 2 degrees, row by row from dark skin.
# Source: X-Rite, "ColorChecker24 - Before November 2014", their measured averages.
COLORCHECKER = np.array(
    [
        (37.986, 13.555, 14.059),
        (65.711, 18.130, 17.810),
        (49.927, -4.880, -21.905),
        (43.139, -13.095, 21.905),
        (55.112, 8.844, -25.399),
        (70.719, -33.397, -0.199),
        (62.661, 36.067, 57.096),
        (40.020, 10.410, -45.964),
        (51.124, 48.239, 16.248),
        (30.325, 22.976, -21.587),
        (72.532, -23.709, 57.255),
        (71.941, 19.363, 67.857),
        (28.778, 14.179, -50.297),
        (55.261, -38.342, 31.370),
        (42.101, 53.378, 28.190),
        (81.733, 4.039, 79.819),
        (51.935, 49.986, -14.574),
        (51.038, -28.631, -28.638),
        (96.539, -0.425, 1.186),
        (81.257, -0.638, -0.335),
        (66.766, -0.734, -0.504),
        (50.867, -0.153, -0.270),
        (35.656, -0.421, -1.231),
        (20.461, -0.079, -0.973),
    ]
)


def xyz_from_lab(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (..., 3) XYZ under D50, Y of a perfect diffuser 1. Source: CIE 15:2018."""
    f_y = (lab[..., 0] + 16) / 116
    f = np.stack([f_y + lab[..., 1] / 500, f_y, f_y - lab[..., 2] / 200], axis=-1)
    cubed = np.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29))
    xyz: NDArray[np.float64] = cubed * np.array(D50)
    return xyz


def rec709_from_xyz(xyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (..., 3) linear Rec.709 of XYZ under D50, adapted to D65 by Bradford."""
    return xyz @ np.linalg.inv(_core.xyz_d50_from_srgb()).T


def rec709_of(patch: Patch) -> NDArray[np.float64]:
    """Return (3,) scene-linear Rec.709 of a patch."""
    color = np.array(patch.color, np.float64)
    if patch.space == "rgb":
        return color
    return rec709_from_xyz(xyz_from_lab(color) if patch.space == "lab" else color)


class PatchChart:
    """A chart of rectangles.

    The surround has the patches' mean: nobody said what it was, and glare needs it."""

    def __init__(self, patches: Sequence[Patch], shape: tuple[int, int], gain: float):
        self.areas = [patch.area for patch in patches]
        self.colors = np.array([rec709_of(patch) for patch in patches]) * gain
        self.shape = shape
        for index, (row, col, height, width) in enumerate(self.areas):
            if row + height > shape[0] or col + width > shape[1]:
                raise ValueError(
                    f"patches[{index}].area ends at row {row + height}, column "
                    f"{col + width}; the frame has {shape[0]} rows, {shape[1]} columns"
                )

    def scene(self) -> FloatImage:
        """Return (H, W, 3) float32."""
        image = np.empty((*self.shape, 3), np.float32)
        image[:] = self.colors.mean(axis=0)
        for (row, col, height, width), color in zip(
            self.areas, self.colors, strict=True
        ):
            image[row : row + height, col : col + width] = color
        return image

    def mask(self) -> NDArray[np.bool_]:
        """Return (H, W), True in the middles of the patches."""
        mask = np.zeros(self.shape, bool)
        for row, col, height, width in self.areas:
            rows, cols = (round(side * (1 - MIDDLE) / 2) for side in (height, width))
            mask[row + rows : row + height - rows, col + cols : col + width - cols] = 1
        return mask


class ColorChecker:
    """A ColorChecker Classic anywhere in the frame, seen in perspective.

    corners : (row, col) of the centres of dark skin, bluish green, black and white: the
        order says how the chart is turned."""

    def __init__(
        self,
        corners: Sequence[Sequence[float]],
        shape: tuple[int, int],
        gain: float,
    ):
        self.shape = shape
        self.colors = rec709_from_xyz(xyz_from_lab(COLORCHECKER)) * gain
        for row, col in corners:
            if row >= shape[0] or col >= shape[1]:
                raise ValueError(
                    f"corners: [{row:g}, {col:g}] is outside the frame of {shape[0]} "
                    f"rows, {shape[1]} columns"
                )
        self.chart_from_pixel = chart_from_pixel(np.array(corners, np.float64))

    def positions(self, rows: slice) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return the patch of each pixel, -1 for none, and its distance.

        distance : the larger of both directions from the centre, in pitches."""
        row, col = np.mgrid[rows, : self.shape[1]].astype(np.float64)
        h = self.chart_from_pixel
        y, x, w = (h[i, 0] * row + h[i, 1] * col + h[i, 2] for i in range(3))
        with np.errstate(divide="ignore", invalid="ignore"):
            y, x = np.where(w > 0, y / w, -9), np.where(w > 0, x / w, -9)
        down, right = np.rint(y), np.rint(x)
        inside = (down >= 0) & (down < GRID[0]) & (right >= 0) & (right < GRID[1])
        index = np.where(inside, down * GRID[1] + right, -1).astype(np.intp)
        return index, np.maximum(abs(y - down), abs(x - right))

    def scene(self) -> FloatImage:
        """Return (H, W, 3) float32."""
        image = np.empty((*self.shape, 3), np.float32)
        palette = np.vstack([self.colors, self.colors.mean(axis=0)]).astype(np.float32)
        for top in range(0, self.shape[0], ROWS):
            rows = slice(top, min(top + ROWS, self.shape[0]))
            index, distance = self.positions(rows)
            image[rows] = palette[np.where(distance < PATCH_OVER_PITCH / 2, index, -1)]
        return image

    def mask(self) -> NDArray[np.bool_]:
        """Return (H, W), True in the middles of the patches."""
        mask = np.zeros(self.shape, bool)
        for top in range(0, self.shape[0], ROWS):
            rows = slice(top, min(top + ROWS, self.shape[0]))
            index, distance = self.positions(rows)
            mask[rows] = (index >= 0) & (distance < MIDDLE * PATCH_OVER_PITCH / 2)
        return mask


def chart_from_pixel(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the 3x3 projective map of (row, col, 1) to rows and columns of patches.

    Raises ValueError for corners that are not those of a convex quadrangle."""
    bottom, right = GRID[0] - 1, GRID[1] - 1
    targets = ((0, 0), (0, right), (bottom, right), (bottom, 0))
    edges = np.roll(corners, -1, axis=0) - corners
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    if not ((turns > 1).all() or (turns < -1).all()):
        raise ValueError(
            "corners: are no quadrangle in the order dark skin, bluish green, black, "
            "white (around the chart)"
        )
    equations, values = [], []
    for (row, col), (y, x) in zip(corners, targets, strict=True):
        equations.append([row, col, 1, 0, 0, 0, -y * row, -y * col])
        equations.append([0, 0, 0, row, col, 1, -x * row, -x * col])
        values += [y, x]
    map_ = np.append(np.linalg.solve(equations, values), 1).reshape(3, 3)
    middle = map_ @ np.append(corners.mean(axis=0), 1)
    upright: NDArray[np.float64] = map_ * np.sign(middle[2])
    return upright
