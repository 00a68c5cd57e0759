# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Three cars and a bus. Metres; a front points to -y at turn 0."""

import math
from itertools import pairwise

import bpy

from .library import geometry, group, materials, paint, render

HEAD, TAIL = (1.0, 0.93, 0.80), (1.0, 0.018, 0.006)
HATCHBACK = (
    (0.0, 0.25), (0.004, 0.50), (0.015, 0.66), (0.06, 0.77), (0.26, 0.93), (0.30, 0.98),
    (0.43, 1.38), (0.52, 1.45), (0.68, 1.43), (0.78, 1.33), (0.90, 1.02), (0.97, 0.96),
    (0.99, 0.86), (0.997, 0.60), (1.0, 0.25),
)  # fmt: skip
SALOON = (
    (0.0, 0.25), (0.004, 0.48), (0.015, 0.64), (0.05, 0.74), (0.27, 0.90), (0.30, 0.94),
    (0.41, 1.32), (0.50, 1.41), (0.62, 1.40), (0.70, 1.30), (0.80, 1.02), (0.84, 0.99),
    (0.97, 0.96), (0.99, 0.84), (0.997, 0.58), (1.0, 0.25),
)  # fmt: skip
VAN = (
    (0.0, 0.28), (0.004, 0.60), (0.015, 0.80), (0.05, 0.95), (0.15, 1.10), (0.18, 1.15),
    (0.29, 1.80), (0.34, 1.93), (0.60, 1.96), (0.94, 1.93), (0.985, 1.80), (0.993, 1.0),
    (0.998, 0.60), (1.0, 0.28),
)  # fmt: skip
# Silhouette, length in m, height of the windows' lower edge, their range along the car.
CARS = {
    "hatchback": (HATCHBACK, 4.2, 0.93, (0.29, 0.90)),
    "saloon": (SALOON, 4.7, 0.90, (0.29, 0.80)),
    "van": (VAN, 4.9, 1.14, (0.17, 0.97)),
}
BUS = (2.5, 11.6, 3.0)


def height_at(silhouette, t):
    """Return the body's height at @t of its length, 0..1."""
    for (t0, h0), (t1, h1) in pairwise(silhouette):
        if t <= t1:
            return h0 + (h1 - h0) * (t - t0) / (t1 - t0)
    return silhouette[-1][1]


def body_point(shape, t, v):
    """Return the surface at @t along the length and @v around, 0..1."""
    silhouette, length, belt, _ = shape
    floor, height, top = 0.24, height_at(silhouette, t), max(h for _, h in silhouette)
    end = abs(2 * t - 1)
    half = 0.89 * (1 - 0.13 * end**5)
    cosine, sine = math.cos(math.pi * v), math.sin(math.pi * v)
    z = floor + (height - floor) * max(sine, 0.0) ** 0.55
    lean = 0.28 * max(0.0, (z - belt + 0.05) / (top - belt + 0.05))
    narrow = 1 - lean - 0.05 * max(0.0, (0.5 - z) / 0.26)
    x = -math.copysign(abs(cosine) ** 0.30, cosine) * half * narrow
    bow = 0.10 * (1 - (x / 0.89) ** 2)
    return x, (t - 0.5) * length + (bow if t > 0.5 else -bow) * end**6, z


def glazing(shape, point):
    """Return how far a point of the body is inside a window, in m; below 0: outside."""
    silhouette, length, belt, (first, last) = shape
    x, y, z = point
    t, top = y / length + 0.5, max(h for _, h in silhouette)
    side = abs(x) > 0.62
    roof = min(top - 0.09, height_at(silhouette, t) - (0.10 if side else -1.0))
    inside = [z - belt, roof - z, (t - first) * length, (last - t) * length]
    if abs(x) > 0.45:  # pillars
        inside += [(abs(t - 0.56) - 0.014) * length, (last - 0.07 - t) * length]
    return min(inside)


def coat(color):
    """Return lacquer with dark glass where the attribute "glazing" is above 0."""
    material, nodes = materials.begin("car_paint")
    inside = nodes.add("Attribute", attribute_name="glazing").outputs["Fac"]
    glass = nodes.math("GREATER_THAN", inside, 0.0)
    materials.finish(
        nodes,
        nodes.mix(glass, color, (0.006, 0.007, 0.008)),
        nodes.remap(glass, 0.0, 1.0, 0.28, 0.03),
        Metallic=nodes.remap(glass, 0.0, 1.0, 0.35, 0.0),
        Coat_Weight=1.0,
        Coat_Roughness=0.03,
    )
    return material


def shell(body, color):
    """Return the painted body with dark glass; cars of one body share its mesh."""
    name, shape = f"shell {body}", CARS[body]
    made = bpy.data.objects.get(name)
    if made is not None:
        twin = geometry.copy(made, geometry.ORIGIN, material=coat(color))
        twin.parent = None
        return twin
    made = geometry.sheet(
        name, lambda u, v: body_point(shape, u, v), 180, 72, coat(color)
    )
    mesh = made.data
    values = [glazing(shape, vertex.co) for vertex in mesh.vertices]
    mesh.attributes.new("glazing", "FLOAT", "POINT").data.foreach_set("value", values)
    return made


def wheels(base, radius, half):
    """Four wheels, @base metres between the axles, at x = +-@half."""
    rubber = paint((0.015, 0.015, 0.016), 0.6)
    alloy = materials.metal("alloy", (0.45, 0.46, 0.48), 0.25)
    for side in (-1, 1):
        for y in (-base / 2, base / 2):
            turn = (0, math.copysign(math.pi / 2, side), 0)
            place = (side * (half - 0.24), y, radius)
            geometry.cylinder("tyre", radius, 0.25, place, rubber, turn, 0.03)
            place = (side * half, y, radius)
            geometry.cylinder("rim", radius * 0.66, 0.02, place, alloy, turn, 0.006)
            for spoke in range(5):
                a = 2 * math.pi * spoke / 5 + y
                r = radius * 0.36
                place = (
                    side * (half + 0.016),
                    y + r * math.cos(a),
                    radius + r * math.sin(a),
                )
                size = (0.014, radius * 0.5, radius * 0.2)
                geometry.box("gap", size, place, rubber, (a, 0, 0), 0.0)


def lights(half, front, rear, heights, lit):
    """Lamps of both ends, with their beams where they are on."""
    head = materials.glow("head_lamp", HEAD, 60.0 if lit else 0.01)
    tail = materials.glow("tail_lamp", TAIL, 12.0 if lit else 0.02)
    for side in (-1, 1):
        x = side * half * 0.66
        place = (x, front + 0.03, heights[0])
        geometry.box("head", (0.30, 0.10, 0.11), place, head, edge=0.04)
        place = (x, rear - 0.005, heights[1])
        geometry.box("tail", (0.30, 0.08, 0.13), place, tail, edge=0.03)
        if not lit:
            continue
        render.light(
            "SPOT",
            (x, front - 0.12, heights[0]),
            220.0,
            color=HEAD,
            target=(x * 1.2, front - 14, -0.2),
            spot_size=1.1,
            spot_blend=0.8,
            shadow_soft_size=0.06,
        )
    if lit:
        place = (0, rear + 0.25, heights[1])
        render.light("POINT", place, 9.0, color=TAIL, shadow_soft_size=0.3)


def car(vehicle):
    """One of the three cars."""
    shape = CARS[vehicle.body]
    length = shape[1]
    shell(vehicle.body, vehicle.paint)
    wheels(length * 0.62, 0.33, 0.86)
    rise = 0.25 if vehicle.body == "van" else 0.0
    heights = (0.63 + rise, 0.80 + rise)
    lights(0.86, -length / 2, length / 2, heights, vehicle.lit)
    plate = materials.glow("plate", (0.9, 0.85, 0.6), 0.12 if vehicle.lit else 0.004)
    geometry.box("plate", (0.5, 0.02, 0.11), (0, length / 2 + 0.09, 0.6), plate)


def bus(vehicle):
    """A town bus with its inside lit."""
    wide, long, tall = BUS
    z0 = 0.32
    lacquer = paint(vehicle.paint, 0.3, Coat_Weight=1.0, Coat_Roughness=0.05)
    geometry.box("bus", (wide, long, 0.95), (0, 0, z0 + 0.475), lacquer, edge=0.08)
    geometry.box("roof", (wide, long, 0.35), (0, 0, tall - 0.17), lacquer, edge=0.12)
    strength = 0.6 if vehicle.lit else 0.03
    inside = materials.glow("bus_inside", (1.0, 0.82, 0.58), strength)
    low, high = z0 + 0.9, tall - 0.3
    middle = (low + high) / 2
    geometry.box(
        "inside", (wide - 0.5, long - 0.6, high - low), (0, 0, middle), inside, edge=0
    )
    glass = materials.pane("bus_glass", (0.75, 0.8, 0.8))
    size = (wide - 0.06, long - 0.06, high - low + 0.1)
    geometry.box("glass", size, (0, 0, middle), glass, edge=0.0)
    dark = paint((0.02, 0.02, 0.022), 0.4)
    for side in (-1, 1):
        for step in range(8):
            y = -long / 2 + 0.06 + step * (long - 0.12) / 7
            place = (side * (wide / 2 - 0.05), y, middle)
            geometry.box("pillar", (0.08, 0.1, high - low + 0.1), place, dark)
            if step < 7:
                seat = (side * (wide / 2 - 0.3), y + 0.9, low + 0.25)
                geometry.box("seat", (0.3, 0.5, 0.62), seat, dark, edge=0.05)
    amber = materials.glow("route", (1.0, 0.45, 0.05), 8.0 if vehicle.lit else 0.01)
    turn = (math.pi / 2, 0, 0)
    place = (0, -long / 2 - 0.02, tall - 0.17)
    geometry.lettering("route", "24 PORT", 0.26, 0.012, amber, place, turn)
    wheels(6.0, 0.47, wide / 2 - 0.04)
    lights(wide / 2, -long / 2, long / 2, (0.75, 0.95), vehicle.lit)


def build(vehicles):
    """Build all vehicles of a scene."""
    for vehicle in vehicles:
        with group(vehicle.place, vehicle.turn):
            bus(vehicle) if vehicle.body == "bus" else car(vehicle)
