# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A shot in colours: as sensitivities see its spectra, or as a renderer has it.

A pixel is a sum of shade x material x light, so the products of spectra are a table of
materials by lights, and no pixel has a spectrum."""

import numpy as np
from numpy.typing import NDArray

from studies.world.colorimetry import (
    Array,
    albedos,
    light_colours,
    observer,
    under_d65,
)
from studies.world.scene import Scene, Shot

Image = NDArray[np.float32]


def seen(shot: Shot, sensitivities: Array) -> Image:
    """Return (H, W, 3) that sensitivities (81, 3) see: an integral over wavelengths."""
    scene = shot.scene
    energy = shot.lights[:, :, None] * sensitivities
    twice = scene.materials * scene.materials[scene.bounced]
    once, again = (
        np.einsum("nw,lwc->lnc", rho, energy, optimize=True)
        for rho in (scene.materials, twice)
    )
    return painted(scene, energy.sum(axis=1), once, again)


def observed(shot: Shot) -> Image:
    """Return (H, W, 3) linear sRGB of the CIE 1931 observer's XYZ, the main light
    adapted to D65: where it is white, 1, 1, 1. Unbounded."""
    xyz = seen(shot, observer()).astype(np.float64)
    return np.asarray(under_d65(xyz, shot.lights[0]), np.float32)


def rendered(shot: Shot) -> Image:
    """Return (H, W, 3) linear sRGB of a renderer, the main light white.

    Albedos are colours under D65, and lights are colours: triples are multiplied."""
    scene = shot.scene
    light = light_colours(shot.lights, shot.lights[0])
    albedo = albedos(scene.materials)
    once = light[:, None] * albedo
    return painted(scene, light, once, once * albedo[scene.bounced])


def painted(scene: Scene, light: Array, once: Array, again: Array) -> Image:
    """Return (H, W, 3) of the colours of white (L, 3), and of materials (L, n, 3) after
    one reflection and after two."""
    leaves = scene.leaves
    image = np.einsum("lhw,lc->hwc", scene.emission, light)
    for shade, direct, indirect in zip(scene.shades, once, again, strict=True):
        for material, share in (
            (leaves.first, 1.0 - leaves.mix),
            (leaves.second, leaves.mix),
        ):
            reflected = direct[material] + scene.bounce[..., None] * indirect[material]
            image += (share * shade)[..., None] * reflected
    return np.asarray(image, np.float32)
