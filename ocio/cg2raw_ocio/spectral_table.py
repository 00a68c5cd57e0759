# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The table of convention spectral: balanced camera RGB of a chromaticity of roots.

With u = sqrt(r), v = sqrt(g), w = sqrt(b) and n = u + 2 v + w, the seven terms of the
core (transform_uplift.h) over n^2 are functions of p = u / n, q = 2 v / n, t = w / n.
Because p + q + t is 1, p^2 is p (1 - q - t): but for the term of grey all is linear in
each of the three, also where one is negative, and trilinear interpolation is exact
however far the nodes are apart. So most of them stand where the term of grey is.

No light that an eye can see lies outside LIMIT: n is above 0 for all of them."""

import itertools

import numpy as np
import PyOpenColorIO as ocio

from .chain import Array, Op

# Of u, v, w in n. With 1, 1, 1 a spectral green would have an n below 0.
WEIGHTS = np.array([1.0, 2.0, 1.0])
# p, q and t of grey.
GREY = WEIGHTS / WEIGHTS.sum()
# The table reaches from -LIMIT to LIMIT; monochromatic lights, 380 to 700 nm, from
# -2.6 to 3.9.
LIMIT = 4.0
SIZE = 33
# Outside of 0.5 to 1.5 of grey's p, q, t the term of grey is below 2e-5 of white.
INNER = 29
# Of the curves that space the nodes; their corners are multiples of 2 LIMIT / 64.
SHAPER_SIZE = 65
# The table is times this, so that it is 1 at white.
SCALE = float(WEIGHTS.sum() ** 2)


def knots(grey: float) -> Array:
    """Return (SIZE,) float64, where the nodes of one axis stand; grey is one of them,
    and so is 0, where roots of negative components begin to count as 0."""
    inner = np.linspace(0.5 * grey, 1.5 * grey, INNER)
    return np.array([-LIMIT, 0.0, *inner, 2.0 * grey, LIMIT])


def ops(uplift: Array) -> list[Op]:
    """R, G, B = p, q, t -> balanced camera RGB times SCALE / n^2; A stays.

    uplift : (3, 7), of the core's CameraTransform."""
    return [shaper(), table(uplift)]


def position(value: float) -> float:
    """Return p, q or t as shaper() takes it, -LIMIT to LIMIT as 0 to 1."""
    return (value + LIMIT) / (2.0 * LIMIT)


def shaper() -> Op:
    """The curves that space the nodes: three of straight lines."""
    places = np.linspace(-LIMIT, LIMIT, SHAPER_SIZE)
    nodes = np.linspace(0.0, 1.0, SIZE)
    curves = [np.interp(places, knots(grey), nodes) for grey in GREY]
    transform = ocio.Lut1DTransform(SHAPER_SIZE, False)
    transform.setData(np.stack(curves, axis=-1).astype(np.float32))
    transform.setInterpolation(ocio.INTERP_LINEAR)
    transform.setFileOutputBitDepth(ocio.BIT_DEPTH_F32)
    return transform


def table(uplift: Array) -> Op:
    """The nodes, red slowest; those that no pixel has a part of are 0."""
    axes = [knots(grey) for grey in GREY]
    p, q, t = np.meshgrid(*axes, indexing="ij")
    values = SCALE * terms(p, q, t) @ uplift.T
    values[~_in_use(axes)] = 0.0
    return _lut3d(values, ocio.INTERP_LINEAR)


def table_of_roots(uplift: Array, limit: float) -> Op:
    """Square roots of the scene over @limit -> square roots of balanced camera RGB."""
    axis = np.linspace(0.0, limit, SIZE)
    u, v, w = np.meshgrid(axis, axis, axis, indexing="ij")
    squares = [u**2, v**2, w**2, u * v, v * w, u * w, grey_term(u, v, w)]
    values = np.stack(squares, axis=-1) @ uplift.T
    return _lut3d(np.sqrt(np.maximum(values, 0.0)), ocio.INTERP_TETRAHEDRAL)


def _lut3d(values: Array, interpolation: ocio.Interpolation) -> Op:
    transform = ocio.Lut3DTransform(SIZE)
    # To 9 digits, which every NumPy computes alike.
    transform.setData(np.round(values, 9).astype(np.float32))
    transform.setInterpolation(interpolation)
    transform.setFileOutputBitDepth(ocio.BIT_DEPTH_F32)
    return transform


def terms(p: Array, q: Array, t: Array) -> Array:
    """Return (..., 7): the core's terms over n^2, linear in each of p, q and t but for
    the last."""
    v = q / WEIGHTS[1]
    linear = [abs(p) * (1 - q - t), abs(v) * (1 - p - t) / 2, abs(t) * (1 - p - q)]
    u, v, w = (np.maximum(x, 0.0) for x in (p, v, t))
    return np.stack([*linear, u * v, v * w, u * w, grey_term(u, v, w)], axis=-1)


def grey_term(u: Array, v: Array, w: Array) -> Array:
    """Return m (rgb / m^3)^8 of roots that are not negative, m = (r + g + b) / 3."""
    mean = (u**2 + v**2 + w**2) / 3.0
    over = np.maximum(mean, 1e-30)
    even: Array = mean * (u * v * w / over**1.5) ** 16
    return even


def _in_use(axes: list[Array]) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """Return which nodes are corners of cells that p + q + t = 1 goes through."""
    ends = [np.stack([axis[:-1], axis[1:]]) for axis in axes]
    low, high = (
        end[0][:, None, None] + end[1][None, :, None] + end[2][None, None, :]
        for end in zip(*ends, strict=True)
    )
    slack = 1e-4  # float32, and more
    crossed = (low <= 1.0 + slack) & (high >= 1.0 - slack)
    used = np.zeros([len(axis) for axis in axes], bool)
    last = SIZE - 1
    for corner in itertools.product((0, 1), repeat=3):
        used[tuple(slice(c, last + c) for c in corner)] |= crossed
    return used
