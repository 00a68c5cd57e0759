# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A reader that follows the DNG specification: file -> mosaic and linear sRGB, float64.

Source: DNG specification 1.7, chapters 5 and 6. It demosaics by mean, which is exact
inside flat patches only."""

import dataclasses

import numpy as np
import tifffile

from . import adobe

CFA_PHOTOMETRIC = 32803


@dataclasses.dataclass
class Dng:
    """Tags of one DNG and its mosaic, already cut to the active area."""

    mosaic: np.ndarray  # (height, width), DN
    cfa: np.ndarray  # (rows, cols), 0 = R, 1 = G, 2 = B
    black: np.ndarray  # (rows, cols) of BlackLevelRepeatDim, DN
    white: float  # DN
    neutral: np.ndarray  # AsShotNeutral
    camera: adobe.Camera
    forward: list  # XYZ D50 from balanced camera, warm first; empty: none
    tags: dict  # of the RAW IFD over those of IFD0, by name

    def signal(self):
        """Linear, 0 at black, 1 at white, not clipped."""
        height, width = self.mosaic.shape
        rows, cols = self.black.shape
        black = np.tile(self.black, (height // rows + 1, width // cols + 1))
        black = black[:height, :width]
        return (self.mosaic - black) / (self.white - black)


def rationals(value):
    """Numerators and denominators in turn -> numbers."""
    pairs = np.reshape(np.array(value, float), (-1, 2))
    return pairs[:, 0] / pairs[:, 1]


def _pages(page):
    yield page
    for inner in page.pages or []:
        yield from _pages(inner)


def _raw_page(tiff):
    for top in tiff.pages:
        for page in _pages(top):
            if page.tags.valueof("PhotometricInterpretation") == CFA_PHOTOMETRIC:
                return page
    raise ValueError("no IFD holds a CFA image")


def _calibrations(tags):
    """[(kelvin, AB CC CM, FM or None)] of the one or two calibrations."""
    balance = tags.get("AnalogBalance")
    balance = np.diag(rationals(balance)) if balance is not None else np.eye(3)
    found = []
    for n in ("1", "2"):
        if f"ColorMatrix{n}" not in tags:
            continue
        calibration = np.eye(3)
        if f"CameraCalibration{n}" in tags:
            calibration = rationals(tags[f"CameraCalibration{n}"]).reshape(3, 3)
        forward = tags.get(f"ForwardMatrix{n}")
        if forward is not None:
            forward = rationals(forward).reshape(3, 3)
        matrix = rationals(tags[f"ColorMatrix{n}"]).reshape(3, 3)
        light = int(tags.get(f"CalibrationIlluminant{n}", 0))
        kelvin = adobe.LIGHT_SOURCE_KELVIN.get(light, 5000.0)
        found.append((kelvin, balance @ calibration @ matrix, forward))
    return sorted(found, key=lambda c: c[0])


def read(path, pixels=True):
    """The DNG at path; without pixels its mosaic is empty. Raises if tags lack."""
    with tifffile.TiffFile(path) as tiff:
        page = _raw_page(tiff)
        tags = {tag.name: tag.value for tag in tiff.pages[0].tags}
        tags.update({tag.name: tag.value for tag in page.tags})
        mosaic = page.asarray() if pixels else np.zeros((0, 0))
    if pixels and "ActiveArea" in tags:
        top, left, bottom, right = tags["ActiveArea"]
        mosaic = mosaic[top:bottom, left:right]
    rows, cols = tags["CFARepeatPatternDim"]
    black = tags.get("BlackLevel", 0)
    dim = tags.get("BlackLevelRepeatDim", (1, 1))
    count = dim[0] * dim[1]
    black = np.atleast_1d(black)
    black = rationals(black) if len(black) == 2 * count else black.astype(float)
    calibrations = _calibrations(tags)
    return Dng(
        mosaic=mosaic.astype(float),
        cfa=np.frombuffer(bytes(tags["CFAPattern"]), np.uint8).reshape(rows, cols),
        black=black.reshape(dim),
        white=float(np.atleast_1d(tags["WhiteLevel"])[0]),
        neutral=rationals(tags["AsShotNeutral"]),
        camera=adobe.Camera([c[0] for c in calibrations], [c[1] for c in calibrations]),
        forward=[c[2] for c in calibrations if c[2] is not None],
        tags=tags,
    )


def patch_means(dng, size):
    """Camera RGB (rows, cols, 3) of flat patches of size x size pixels."""
    signal = dng.signal()
    height, width = signal.shape
    color = np.tile(dng.cfa, (size, size))[:size, :size]
    if size % dng.cfa.shape[0] or size % dng.cfa.shape[1]:
        raise ValueError("a patch must hold whole CFA patterns")
    patches = signal[: height // size * size, : width // size * size]
    patches = patches.reshape(height // size, size, width // size, size)
    patches = patches.transpose(0, 2, 1, 3)
    return np.stack([patches[:, :, color == c].mean(axis=-1) for c in range(3)], -1)


def srgb_from_camera(dng):
    """The matrix of the specification's chapter 6, for unbalanced camera RGB.

    White, the neutral over its maximum, becomes (1, 1, 1)."""
    neutral = adobe.rounded_neutral(dng.neutral)
    xy = dng.camera.xy_from_neutral(neutral)[0]
    camera_from_xyz = dng.camera.camera_from_xyz(xy)
    white = camera_from_xyz @ adobe.xyz(xy)
    white /= np.max(white)
    if len(dng.forward) == len(dng.camera.kelvin):
        weight = dng.camera.warm_weight(xy)
        forward = weight * dng.forward[0] + (1.0 - weight) * dng.forward[-1]
        scale = adobe.xyz(adobe.D50) / np.sum(forward, axis=1)
        xyz_d50_from_camera = scale[:, None] * forward @ np.diag(1.0 / white)
    else:
        camera_from_d50 = camera_from_xyz @ adobe.bradford(xy, adobe.D50)
        camera_from_d50 /= np.max(camera_from_d50 @ adobe.xyz(adobe.D50))
        xyz_d50_from_camera = np.linalg.inv(camera_from_d50)
    return np.linalg.solve(adobe.xyz_d50_from_srgb(), xyz_d50_from_camera)


def cool_matrix_srgb_from_camera(dng):
    """The matrix of readers that know one ColorMatrix, row-normalised, and the neutral.

    So LibRaw and dcraw do: they take the matrix of the cooler light."""
    neutral = adobe.rounded_neutral(dng.neutral)
    camera_from_srgb = dng.camera.matrices[-1] @ adobe.xyz_d65_from_srgb()
    balanced_from_srgb = camera_from_srgb / camera_from_srgb.sum(axis=1, keepdims=True)
    return np.linalg.solve(balanced_from_srgb, np.diag(1.0 / neutral))
