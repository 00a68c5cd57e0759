# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convention spectral by OCIO against the core: how far its table is off."""

import itertools

import numpy as np
import PyOpenColorIO as ocio
import pytest

from cg2raw import _core
from cg2raw_ocio import measure, spectral_chain, spectral_table
from cg2raw_ocio.spaces import group
from ocio.pixels import BLACK_AND_WHITE
from oracles import spectral

DN = 65535.0
SENSORS = ("canon-5d", "canon-600d", "nikon-d850")
LIGHTS = ("A", "D65", "FL2", "LED-B3", "2000K", "sample:1")
CHAIN = "spectral_chain.camera_from_scene"
# Of the term of grey, of which white has 1: nodes are 0.0089 (p, t) and 0.0179 (q)
# apart, and the second differences of the term between them sum to 0.011.
GREY_TERM = 0.012
# OpenColorIO 2.6 takes roots to 8e-6, which is 1 DN of white.
FLOAT_DN = 1.5


def transforms():
    """Return {what: CameraTransform} of convention spectral."""
    loaded = {sensor: _core.load_profile(sensor) for sensor in SENSORS}
    return {
        (sensor, light): _core.camera_from_scene(
            loaded[sensor], loaded[sensor].illuminant(light), "spectral"
        )
        for sensor, light in itertools.product(SENSORS, LIGHTS)
    }


def visible(count, rng):
    """Return (count, 3) linear Rec.709 of mixtures of up to three monochromatic lights
    of 380 to 700 nm, the largest component 1 or -1."""
    locus = spectral.observer()[:65] @ np.linalg.inv(_core.xyz_d65_from_srgb()).T
    weights = rng.dirichlet([0.4] * 3, count)[..., None]
    mixed = (locus[rng.integers(0, len(locus), (count, 3))] * weights).sum(axis=1)
    colours = np.concatenate([locus, mixed])
    return colours / np.abs(colours).max(axis=1, keepdims=True)


def kinds_of_pixels(count=4000):
    """Return {kind: (N, 3) float32} of colours that a light can have."""
    rng = np.random.default_rng(3)
    unit, one = rng.random((count, 3)), np.eye(3)[rng.integers(3, size=count)]
    kinds = {
        "unit": unit,
        "dark": unit * 10.0 ** rng.uniform(-6, -1, (count, 1)),
        "bright": unit * 10.0 ** rng.uniform(0, 4, (count, 1)),
        "neutral": np.repeat(np.geomspace(1e-6, 1e5, count)[:, None], 3, axis=1),
        "nearly neutral": unit[:, :1] * np.exp(rng.normal(0, 0.3, (count, 3))),
        "saturated": unit**8,
        "two components": unit * (1 - one),
        "one component": unit * one,
        "visible": visible(count, rng),
    }  # fmt: skip
    return {kind: rgb.astype(np.float32) for kind, rgb in kinds.items()}


def core(transform, rgb):
    """Return (N, 3) float64 of the core's camera RGB."""
    return _core.to_camera(transform, np.ascontiguousarray(rgb)[None])[0].astype(float)


def error_dn(found, exact):
    """Return (N, 3) errors, DN of 65535; of a bright pixel relative to its largest
    channel."""
    scale = np.maximum(exact.max(axis=1, keepdims=True), 1.0)
    return np.abs(found - exact) / scale * DN


def degrees(found, exact):
    """Return the angles between rows that are not black."""
    kept = exact.max(axis=1) > 1e-6
    a, b = (x[kept] / np.linalg.norm(x[kept], axis=1)[:, None] for x in (found, exact))
    # Of the chord: a cosine has no digits left for small angles.
    return np.degrees(2 * np.arcsin(np.linalg.norm(a - b, axis=1) / 2))


def limit_dn(transform):
    """Return what the largest error may be, DN."""
    lost = np.abs(np.asarray(transform.uplift)[:, 6]) * transform.gains
    return GREY_TERM * lost.max() * DN + FLOAT_DN


def test_the_table_is_as_near_as_its_nodes_are(chains_of):
    asked = transforms()
    kinds = kinds_of_pixels()
    rgb = np.concatenate(list(kinds.values()))
    cuts = np.cumsum([len(kind) for kind in kinds.values()])[:-1]
    results = chains_of(CHAIN, list(asked.values()), rgb)
    for (what, transform), found in zip(asked.items(), results, strict=True):
        exact = core(transform, rgb)
        error = error_dn(found.astype(float), exact)
        for kind, part in zip(kinds, np.split(error, cuts), strict=True):
            assert part.max() <= limit_dn(transform), (what, kind)
            assert part.mean() <= 1.5, (what, kind)
            if kind in ("neutral", "one component"):  # no table error at all
                assert part.max() <= FLOAT_DN, (what, kind)
        assert error.max() <= 22.0, what
        assert degrees(found.astype(float), exact).max() <= 0.01, what


def test_the_table_loses_less_than_it_gains(chains_of):
    """A hundredth of the angle to convention dng's colours, on average."""
    rgb = kinds_of_pixels()["unit"]
    asked = transforms()
    results = chains_of(CHAIN, list(asked.values()), rgb)
    for ((sensor, light), transform), found in zip(asked.items(), results, strict=True):
        profile = _core.load_profile(sensor)
        matrix = core(
            _core.camera_from_scene(profile, profile.illuminant(light), "sensor"), rgb
        )
        exact = core(transform, rgb)
        gained = degrees(matrix, exact).mean()
        assert degrees(found.astype(float), exact).mean() <= gained / 100
        assert gained > 0.5


def test_what_is_no_radiance_is_black_or_saturates(chains_of):
    rgb = np.array(sum(BLACK_AND_WHITE.values(), []), np.float32)
    blacks = len(BLACK_AND_WHITE["black"])
    for camera in chains_of(CHAIN, list(transforms().values()), rgb):
        assert (camera[:blacks] == 0).all()
        assert camera[blacks:].min() > 0.3 and np.isfinite(camera).all()
        assert camera[blacks : blacks + 4].min() > 1e4


def test_black_is_black(chains_of):
    """Also where a component is negative and no light could be."""
    rgb = np.float32(
        [[0, 0, 0], [-1, -1, -1], [-1e-6, 0, 0], [0, -1, 0], [0.1, -1, 0.1]]
    )
    for camera in chains_of(CHAIN, list(transforms().values()), rgb):
        assert (camera == 0).all()


def test_twice_the_light_is_twice_the_camera_rgb():
    """The table does not know the exposure."""
    [transform, *_] = transforms().values()
    chain = group(spectral_chain.camera_from_scene(transform))
    rgb = kinds_of_pixels(500)["unit"]
    one, more = (measure.applied(chain, rgb * np.float32(f)) for f in (1, 4096))
    np.testing.assert_allclose(more / 4096, one, atol=FLOAT_DN / DN)


def test_all_visible_lights_are_in_the_table():
    rgb = visible(20000, np.random.default_rng(4))
    roots = np.sign(rgb) * np.sqrt(np.abs(rgb)) * spectral_table.WEIGHTS
    sums = roots.sum(axis=1, keepdims=True)
    assert sums.min() > 0.2
    assert np.abs(roots / sums).max() < spectral_table.LIMIT


@pytest.mark.parametrize("planted", ["no term of grey", "tetrahedral", "a node"])
def test_a_planted_error_is_found(planted):
    transform = transforms()["canon-5d", "2000K"]
    ops = spectral_chain.camera_from_scene(transform)
    place = next(i for i, op in enumerate(ops) if isinstance(op, ocio.Lut3DTransform))
    table = ops[place]
    if planted == "no term of grey":
        without = np.array(transform.uplift)
        without[:, 6] = 0.0
        ops[place] = spectral_table.table(without)
    elif planted == "tetrahedral":
        table.setInterpolation(ocio.INTERP_TETRAHEDRAL)
    else:
        nodes = np.array(table.getData()).reshape(spectral_table.SIZE, -1, 3)
        nodes[16] *= 1.01  # all with the p of grey
        table.setData(nodes.reshape([spectral_table.SIZE] * 3 + [3]))
    kinds = kinds_of_pixels()
    rgb = np.concatenate([kinds["unit"], kinds["nearly neutral"]])
    found = measure.applied(group(ops), rgb).astype(float)
    assert error_dn(found, core(transform, rgb)).max() > 3 * limit_dn(transform)
