# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Patch frames: tables of patch means in the shape of frames.

Each patch is a tile of one CFA repeat, whose pixels have the means and the variance of
one pixel, divided by the number of those in the mean: all that a mean says. Around it
lies light of its own colour, and it is in the middle of the sensor: what depends on
neighbours or on the place says nothing, and no effect of these is named from it."""

import numpy as np

from cg2raw import _core
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.chart_table import places_of
from cg2raw.diagnose.captures.patch_means import COLOR_OF_SITE, PatchMeans
from cg2raw.diagnose.frames.frame import Frame, camera_of, camera_tiles, planes_of_sites
from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.frames.tiling import MARGIN, Array, Tiling

SIDE = 2  # of a Bayer repeat
WHOLE = 64  # px a side of the light that glare comes from


def patch_frame_of(
    capture_set: CaptureSet, capture: Capture, noise: NoiseModel
) -> Frame:
    """Return the frame of a capture that has means; arrays are (P, 2, 2)."""
    means, sensor = capture.means, capture_set.sensor
    assert means is not None
    matrix, light = camera_of(capture_set, capture)
    site, color, black = planes_of_sites(sensor.cfa, (SIDE, SIDE), sensor.black_level)
    range_ = sensor.white_level - black
    beta1, beta2 = (
        planes_of_sites(sensor.cfa, (SIDE, SIDE), beta)[2]
        for beta in (noise.beta1, noise.beta2)
    )
    side = on_sites(means.side, sensor.cfa)
    # A censored pixel lies beyond half a DN from its end; a mean beyond its bound.
    bound = on_sites(means.mean, sensor.cfa) + 0.5 * side
    signal = np.where(np.isfinite(bound), (bound - black) / range_, 0.0)
    is_free = "exposure" in capture_set.nuisances or not means.level_known
    camera = np.maximum(means.colors @ matrix.T, 0)
    if is_free:
        camera *= brightness(camera, signal, means, sensor.cfa)
    tiles = tiles_of(len(means.names), (sensor.height, sensor.width))
    planes = camera_tiles(camera.astype(np.float32), tiles)
    # Nobody said what was around the patches: light with their mean.
    whole = np.full((WHOLE, WHOLE, 3), camera.mean(axis=0).astype(np.float32))
    context = _core.glare_context(whole)
    return Frame(
        capture=capture,
        tiles=tiles,
        signal=signal,
        at_white=side > 0,
        at_zero=side < 0,
        keep=np.isfinite(bound),
        camera=planes,
        glare_context=context,
        neutral=tuple(np.asarray(light.neutral) / max(light.neutral)),
        noise=noise,
        beta1=beta1,
        beta2=beta2,
        range=range_,
        site=site,
        color=color,
        rendered=(planes, context),
        level_free=is_free,
        samples=np.broadcast_to(means.count[:, None, None], side.shape),
    )


def on_sites(values: Array, cfa: str) -> Array:
    """Return (P, 2, 2) at the sites of a Bayer CFA of (P, 4), of R, G1, G2 and B."""
    order = np.argsort(places_of(cfa))
    return values[:, order].reshape(-1, SIDE, SIDE)


def brightness(camera: Array, signal: Array, means: PatchMeans, cfa: str) -> float:
    """Return how bright a chart was: least squares, so that bright patches say it, in
    which an offset is small.

    camera : (P, 3). signal : (P, 2, 2). 1 where no patch was measured."""
    predicted = on_sites(camera[:, COLOR_OF_SITE], cfa)
    used = on_sites(means.measured, cfa) & (predicted > 0)
    square = float((predicted[used] ** 2).sum())
    found = float((predicted * signal)[used].sum()) / square if square > 0 else 1.0
    return found if found > 0 else 1.0


def tiles_of(count: int, shape: tuple[int, int]) -> Tiling:
    """Return as many tiles of one repeat, all in the middle of a frame (H, W)."""
    middle = [length // 2 // SIDE * SIDE for length in shape]
    origins = np.tile(np.array([middle], np.int32), (count, 1))
    return Tiling(shape, (SIDE, SIDE), MARGIN, origins)
