# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Render a wet street at night: sodium and LED lamps, neon, shops, cars.

Usage: python night_street.py OUT.exr [--samples N] [--width W]
Units: metres, radiance such that the picture's mean is near 0.05."""

import math
import random

import scene_geometry as geometry
import scene_materials as materials
import scene_render as render
import street_facades as facades
import street_props as props

ASPECT = 16 / 9
ROAD, WALL = 4.2, facades.WALL  # half widths between kerbs and between facades
FAR = 78.0


def puddles(nodes):
    """Return 1 where water stands on the road, 0 elsewhere, by place."""
    position = nodes.add("NewGeometry").outputs["Position"]
    return nodes.remap(nodes.noise(position, 0.42, 5.0, 0.5, 0.6), 0.52, 0.60)


def asphalt():
    """Wet asphalt: stone relief, a film of water, mirror-like puddles."""
    material, nodes = materials.begin("asphalt")
    position = nodes.coordinates()
    puddle = puddles(nodes)
    stones = nodes.add("TexVoronoi", {"Vector": position, "Scale": 75.0}).outputs[0]
    fine = nodes.noise(position, 160.0, 4.0, 0.7)
    stain = nodes.noise(position, 1.1, 7.0, 0.65)
    dry = nodes.mix(
        nodes.remap(stain, 0.3, 0.7), (0.018, 0.018, 0.020), (0.050, 0.049, 0.047)
    )
    dry = nodes.mix(nodes.remap(stones, 0.1, 0.5, 0.5, 0.0), dry, (0.085, 0.083, 0.08))
    color = nodes.mix(puddle, dry, (0.010, 0.010, 0.010))
    film = nodes.remap(nodes.noise(position, 0.9, 5.0), 0.35, 0.65, 0.16, 0.36)
    rough = nodes.math("MULTIPLY", film, nodes.remap(puddle, 0.0, 1.0, 1.0, 0.10))
    relief = nodes.math("ADD", nodes.math("MULTIPLY", stones, 0.7), fine)
    relief = nodes.math("MULTIPLY", relief, nodes.remap(puddle, 0.0, 0.8, 1.0, 0.0))
    ripple = nodes.math("MULTIPLY", nodes.noise(position, 5.0, 2.0), 0.35)
    normal = nodes.bump(nodes.math("ADD", relief, ripple), 0.006, 0.42)
    materials.finish(nodes, color, rough, normal, IOR=1.36)
    return material


def slabs():
    """Damp concrete paving, 0.6 by 0.4 m."""
    material, nodes = materials.begin("slabs")
    position = nodes.coordinates()
    bricks = nodes.add(
        "TexBrick",
        {
            "Vector": position,
            "Color1": (0.07, 0.068, 0.064),
            "Color2": (0.12, 0.115, 0.108),
            "Mortar": (0.02, 0.02, 0.02),
            "Scale": 1.0,
            "Mortar Size": 0.006,
            "Brick Width": 0.6,
            "Row Height": 0.4,
        },
    )
    fine = nodes.noise(position, 60.0, 6.0, 0.7)
    damp = nodes.noise(position, 0.7, 5.0)
    color = nodes.mix(
        nodes.remap(fine, 0.4, 0.7, 0, 0.4), bricks.outputs["Color"], (0.03, 0.03, 0.03)
    )
    rough = nodes.remap(damp, 0.4, 0.6, 0.12, 0.4)
    depth = nodes.math(
        "SUBTRACT", nodes.math("MULTIPLY", fine, 0.3), bricks.outputs["Fac"]
    )
    materials.finish(nodes, color, rough, nodes.bump(depth, 0.004, 0.5), IOR=1.36)
    return material


def worn_paint():
    """White road paint, worn through in places, under the same puddles."""
    material, nodes = materials.begin("road_paint")
    puddle = puddles(nodes)
    wear = nodes.noise(nodes.coordinates(), 9.0, 8.0, 0.75)
    color = nodes.mix(
        nodes.remap(wear, 0.44, 0.60), (0.42, 0.41, 0.38), (0.04, 0.04, 0.04)
    )
    color = nodes.mix(nodes.math("MULTIPLY", puddle, 0.7), color, (0.02, 0.02, 0.02))
    fine = nodes.math(
        "MULTIPLY",
        nodes.noise(nodes.coordinates(), 120.0, 3.0),
        nodes.remap(puddle, 0.0, 0.8, 1.0, 0.0),
    )
    rough = nodes.remap(puddle, 0.0, 1.0, 0.22, 0.03)
    materials.finish(nodes, color, rough, nodes.bump(fine, 0.002, 0.4), IOR=1.36)
    return material


def ground():
    """Road, kerbs, pavements, markings, a manhole."""
    span = geometry.span
    span("road", (-ROAD, -12, -0.2), (ROAD, FAR, 0), asphalt(), edge=0.0)
    span("cross_road", (-60, FAR - 12, -0.2), (60, FAR, -0.002), asphalt(), edge=0.0)
    granite = materials.plaster("granite", (0.15, 0.145, 0.14), 0.001, 120.0, 0.4)
    paving, paint = slabs(), worn_paint()
    for side in (-1, 1):
        low, high = sorted((side * (ROAD + 0.18), side * (WALL + 1.8)))
        span("pavement", (low, -12, -0.1), (high, FAR - 12, 0.135), paving, edge=0.0)
        for step in range(56):
            low, high = sorted((side * ROAD, side * (ROAD + 0.18)))
            span(
                "kerb",
                (low, -12 + step * 1.4, -0.1),
                (high, -10.61 + step * 1.4, 0.14),
                granite,
                edge=0.012,
            )
    for step in range(8):
        x = -3.85 + step * 1.1
        span("zebra", (x - 0.26, 7.2, -0.01), (x + 0.26, 10.2, 0.003), paint, edge=0.0)
    span("stop_line", (0.1, 5.9, -0.01), (ROAD - 0.2, 6.25, 0.003), paint, edge=0.0)
    for step in range(11):
        y = 13.0 + step * 5.2
        span("dash", (-0.07, y, -0.01), (0.07, y + 2.4, 0.003), paint, edge=0.0)
    iron = materials.metal("manhole", (0.14, 0.13, 0.12), 0.25, 0.3)
    geometry.cylinder("manhole", 0.34, 0.012, (-1.5, 4.3, -0.006), iron)


def lamps():
    """Sodium lamps along the left kerb, LED lamps along the right one."""
    for y in (9.5, 27.0, 44.0, 60.0):
        props.street_lamp((-ROAD - 0.45, y, 0.13), -1, props.SODIUM, 520.0)
    for y in (18.0, 36.0, 53.0):
        props.street_lamp((ROAD + 0.45, y, 0.13), 1, props.LED, 420.0)
    props.festoon((-WALL, 14.5, 6.6), (WALL, 16.0, 6.3), 0.9, 15)
    props.festoon((-WALL, 30.0, 7.0), (WALL, 29.0, 6.8), 1.0, 15)


def signs():
    """Neon blades over the pavement and letters on the facades."""
    upright = render.degrees(90, 0, 0)
    props.neon(
        "H\nO\nT\nE\nL",
        0.72,
        (1.0, 0.02, 0.012),
        26.0,
        (-5.75, 13.2, 6.3),
        upright,
        (0.85, 3.5),
        0.016,
    )
    props.neon(
        "BAR",
        0.62,
        (0.03, 0.10, 1.0),
        34.0,
        (5.75, 19.5, 4.9),
        upright,
        (1.55, 0.85),
        0.014,
    )
    props.neon(
        "CAFE",
        0.60,
        (0.02, 1.0, 0.16),
        20.0,
        (-WALL + 0.06, 12.6, 3.50),
        render.degrees(90, 0, 90),
        None,
        0.015,
    )
    props.neon(
        "24",
        0.55,
        (1.0, 0.03, 0.55),
        24.0,
        (5.7, 11.6, 4.3),
        upright,
        (0.95, 0.75),
        0.014,
    )
    props.neon(
        "KINO",
        0.8,
        (0.05, 0.85, 1.0),
        20.0,
        (-5.6, 25.5, 5.2),
        upright,
        (2.4, 1.1),
        0.018,
    )
    props.neon_ring(0.45, (1.0, 0.35, 0.02), 22.0, (5.75, 30.5, 5.0), upright)


def traffic():
    """One car leaves, one comes, one is parked under the lamp."""
    props.car((1.95, 14.6, 0), math.pi, (0.015, 0.02, 0.03), 0.0, 14.0)
    props.car((-2.0, 26.5, 0), 0.0, (0.25, 0.25, 0.26), 180.0, 0.0)
    props.car((3.25, 7.6, 0), math.pi, (0.30, 0.015, 0.012), 0.0, 0.0)
    props.car((-3.25, 16.5, 0), 0.02, (0.02, 0.06, 0.12), 0.0, 0.0)
    props.car((2.1, 44.0, 0), math.pi, (0.1, 0.1, 0.1), 0.0, 12.0)
    props.traffic_light((4.62, 10.9, 0.13))
    for y in (1.6, 3.4, 5.2, 11.9, 13.7):
        props.bollard((-ROAD - 0.5, y, 0.13))


def main():
    """Build the street and render it."""
    options = render.arguments(__doc__, 64, 1920)
    render.begin()
    ground()
    facades.row(random.Random(21), -1)
    facades.row(random.Random(8), 1)
    facades.closing(random.Random(4), FAR)
    lamps()
    signs()
    traffic()
    render.sky((0.010, 0.009, 0.010), (0.0022, 0.0028, 0.0048), (0.002, 0.002, 0.002))
    render.camera((-0.55, -1.2, 1.5), (0.05, 30.0, 1.5), 27.0, 0.075)
    render.run(options, ASPECT, 2)


if __name__ == "__main__":
    main()
