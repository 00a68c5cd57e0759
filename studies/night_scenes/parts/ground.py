# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Roads, pavements, squares and water; wet is 0 dry to 1 with puddles. Metres."""

from .library import geometry, materials


def puddles(nodes, wet):
    """Return 1 where water stands, 0 elsewhere; none where it is dry."""
    if wet < 0.25:
        return 0.0
    position = nodes.add("NewGeometry").outputs["Position"]
    level = 0.66 - 0.14 * wet
    return nodes.remap(nodes.noise(position, 0.42, 5.0, 0.5, 0.6), level, level + 0.08)


def surface(name, color, relief, depth, wet, dry_rough):
    """Finish a ground of some colour and relief under a film of water."""
    material, nodes = materials.begin(name)
    color, relief = color(nodes), relief(nodes)
    puddle = puddles(nodes, wet)
    film = nodes.noise(nodes.coordinates(), 0.9, 5.0)
    low = dry_rough + (0.14 - dry_rough) * wet
    rough = nodes.remap(film, 0.35, 0.65, low, low + 0.16)
    rough = nodes.math("MULTIPLY", rough, nodes.math("SUBTRACT", 1.05, puddle))
    dark = nodes.mix(0.55 * wet, color, (0.006, 0.006, 0.006))
    dark = nodes.mix(puddle, dark, (0.008, 0.008, 0.008))
    flat = nodes.math("MULTIPLY", relief, nodes.math("SUBTRACT", 1.0, puddle))
    materials.finish(nodes, dark, rough, nodes.bump(flat, depth, 0.45), IOR=1.36)
    return material


def asphalt(wet):
    """Stones in bitumen, stained."""

    def color(nodes):
        stain = nodes.noise(nodes.coordinates(), 1.1, 7.0, 0.65)
        stones = nodes.add("TexVoronoi", {"Vector": nodes.coordinates(), "Scale": 75.0})
        base = nodes.mix(
            nodes.remap(stain, 0.3, 0.7), (0.03, 0.03, 0.033), (0.075, 0.073, 0.07)
        )
        spots = nodes.remap(stones.outputs[0], 0.1, 0.5, 0.5, 0.0)
        return nodes.mix(spots, base, (0.11, 0.108, 0.10))

    def relief(nodes):
        return nodes.noise(nodes.coordinates(), 120.0, 4.0, 0.7)

    return surface("asphalt", color, relief, 0.005, wet, 0.6)


def blocks(name, wet, size, first, second, mortar, rough=0.55):
    """Paving of @size (length, depth) in m with joints of @mortar m."""

    def bricks(nodes):
        return nodes.add(
            "TexBrick",
            {
                "Vector": nodes.coordinates(),
                "Color1": first,
                "Color2": second,
                "Mortar": (0.02, 0.02, 0.02),
                "Scale": 1.0,
                "Mortar Size": mortar,
                "Brick Width": size[0],
                "Row Height": size[1],
            },
        )

    def color(nodes):
        fine = nodes.remap(
            nodes.noise(nodes.coordinates(), 30.0, 6.0, 0.7), 0.4, 0.7, 0, 0.5
        )
        return nodes.mix(fine, bricks(nodes).outputs["Color"], (0.04, 0.04, 0.04))

    def relief(nodes):
        joints = nodes.math("SUBTRACT", 1.0, bricks(nodes).outputs["Fac"])
        fine = nodes.noise(nodes.coordinates(), 50.0, 5.0, 0.7)
        return nodes.math("ADD", joints, nodes.math("MULTIPLY", fine, 0.3))

    return surface(name, color, relief, 0.004, wet, rough)


def slabs(wet):
    """Concrete slabs, 0.6 by 0.4 m."""
    return blocks(
        "slabs", wet, (0.6, 0.4), (0.10, 0.097, 0.09), (0.16, 0.155, 0.145), 0.006
    )


def cobbles(wet):
    """Small granite blocks."""
    return blocks(
        "cobbles", wet, (0.16, 0.11), (0.07, 0.07, 0.072), (0.15, 0.145, 0.14), 0.01
    )


SURFACES = {"slabs": slabs, "cobbles": cobbles}


def paint_line(wet):
    """Worn white road paint."""
    return materials.plain("road_paint", (0.36, 0.355, 0.33), 0.55 - 0.3 * wet)


def road(half, wall, wet, near=-12.0, far=66.0):
    """A road with kerbs and pavements along y; half widths in m; 0: paving alone."""
    span = geometry.span
    if not half:
        low, high = (-wall - 1.8, near, -0.2), (wall + 1.8, far, 0.0)
        span("paving", low, high, cobbles(wet), edge=0.0)
        return
    span("road", (-half, near, -0.2), (half, far, 0), asphalt(wet), edge=0.0)
    granite = materials.plaster("granite", (0.15, 0.145, 0.14), 0.001, 120.0, 0.4)
    paving, line = slabs(wet), paint_line(wet)
    for side in (-1, 1):
        low, high = sorted((side * (half + 0.18), side * (wall + 1.8)))
        span("pavement", (low, near, -0.1), (high, far, 0.135), paving, edge=0.0)
        low, high = sorted((side * half, side * (half + 0.18)))
        span("kerb", (low, near, -0.1), (high, far, 0.14), granite, edge=0.012)
    for step in range(int((far - 13) / 5.2) if half > 3 else 0):
        y = 13.0 + step * 5.2
        span("dash", (-0.07, y, -0.01), (0.07, y + 2.4, 0.003), line, edge=0.0)
    for step in range(int(2 * half / 1.1)):
        x = -half + 0.5 + step * 1.1
        span("zebra", (x - 0.26, 7.2, -0.01), (x + 0.26, 10.2, 0.003), line, edge=0.0)
    iron = materials.metal("manhole", (0.14, 0.13, 0.12), 0.25, 0.3)
    geometry.cylinder("manhole", 0.34, 0.012, (-half / 3, 4.3, -0.006), iron)


def beyond(y, wet):
    """A road across the end of a street."""
    geometry.span("cross", (-60, y, -0.2), (60, y + 8, -0.002), asphalt(wet), edge=0.0)


def water(level, x0, x1, y0, y1, waves=1.0):
    """A surface of water at height @level, rippled by wind."""
    material, nodes = materials.begin("water")
    position = nodes.coordinates((1.0, 1.6, 1.0))
    swell = nodes.noise(position, 0.55, 3.0, 0.5, 0.4)
    ripple = nodes.noise(position, 2.6, 3.0, 0.6)
    relief = nodes.math("ADD", nodes.math("MULTIPLY", swell, 1.6), ripple)
    normal = nodes.bump(relief, 0.06 * waves, 0.5)
    materials.finish(nodes, (0.004, 0.007, 0.008), 0.03, normal, IOR=1.33)
    geometry.span("water", (x0, y0, level - 0.1), (x1, y1, level), material, edge=0.0)
