# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The sky, the moon and haze."""

import bpy

from .library import geometry, materials, render

GROUND = (0.002, 0.002, 0.002)  # radiance below the horizon
MOON_ANGLE = 0.0093  # radians, its diameter
HAZE_BOX = ((-90.0, -20.0, -0.3), (90.0, 130.0, 24.0))  # m


def build(scene):
    """Fill the world with the sky of @scene, its moon and the haze of its air."""
    sky = scene.sky
    cloud = tuple(1.5 * c for c in sky.horizon) if sky.name == "cloud" else None
    render.sky(sky.horizon, sky.zenith, GROUND, cloud)
    if sky.moon:
        moon = render.light("SUN", (0, 0, 30), sky.moon, 4100, angle=MOON_ANGLE)
        render.aim(
            moon, tuple(30 * (k == 2) - 30 * c for k, c in enumerate(sky.moon_from))
        )
    if scene.weather.haze:
        haze(scene.weather.haze)


def haze(density):
    """Fill the air with droplets that scatter @density of light a metre."""
    material, nodes = materials.begin("haze")
    volume = nodes.add("VolumeScatter", {"Density": density, "Anisotropy": 0.6})
    nodes.add("OutputMaterial", {"Volume": volume.outputs[0]})
    geometry.span("haze", *HAZE_BOX, material, edge=0.0)
    bpy.context.scene.cycles.volume_bounces = 0
