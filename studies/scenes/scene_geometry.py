# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Meshes and curves of the test scenes. Lengths in metres, angles in radians, z up."""

import math

import bpy

# isort: split
import bmesh  # exists only once bpy is loaded

SHARP_ANGLE = math.radians(38)  # edges sharper than this keep a crease
ORIGIN = (0.0, 0.0, 0.0)


def place(name, data, material, location=ORIGIN, rotation=ORIGIN):
    """Link new object data into the scene and return the object."""
    item = bpy.data.objects.new(name, data)
    if material is not None and not data.materials:
        data.materials.append(material)
    item.location = location
    item.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(item)
    return item


def mesh(name, vertices, faces, smooth=False):
    """Return a mesh with consistent outward normals, creased at SHARP_ANGLE."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    editor = bmesh.new()
    editor.from_mesh(data)
    bmesh.ops.remove_doubles(editor, verts=editor.verts, dist=1e-6)
    bmesh.ops.recalc_face_normals(editor, faces=editor.faces)
    editor.to_mesh(data)
    editor.free()
    data.shade_smooth() if smooth else data.shade_flat()
    if smooth:
        data.set_sharp_from_angle(angle=SHARP_ANGLE)
    return data


def bevel(item, width, segments=2):
    """Round the edges of @p item by @p width metres."""
    modifier = item.modifiers.new("bevel", "BEVEL")
    modifier.width = width
    modifier.segments = segments
    modifier.limit_method = "ANGLE"
    return item


def box(name, size, location, material, rotation=ORIGIN, edge=0.003):
    """Return a box of full @p size centred on @p location, edges rounded by edge."""
    x, y, z = (length / 2 for length in size)
    corners = [(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
    faces = [
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    ]
    item = place(name, mesh(name, corners, faces), material, location, rotation)
    return bevel(item, edge) if edge > 0 else item


def span(name, low, high, material, edge=0.003):
    """Return the box between two opposite corners, in metres."""
    size = [b - a for a, b in zip(low, high, strict=True)]
    centre = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    return box(name, size, centre, material, edge=edge)


def lathe(name, profile, location, material, rotation=ORIGIN, segments=64):
    """Revolve @p profile, a list of (radius, height) in metres, about z."""
    vertices, faces = [], []
    for radius, height in profile:
        for step in range(segments):
            angle = 2 * math.pi * step / segments
            vertices.append(
                (radius * math.cos(angle), radius * math.sin(angle), height)
            )
    for ring in range(len(profile) - 1):
        for step in range(segments):
            following = (step + 1) % segments
            a, b = ring * segments, (ring + 1) * segments
            faces.append((a + step, a + following, b + following, b + step))
    return place(name, mesh(name, vertices, faces, True), material, location, rotation)


def rounded(knots, steps=8):
    """Return @p knots of a profile joined by a Catmull-Rom curve."""
    padded = [knots[0], *knots, knots[-1]]
    points = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        for step in range(steps):
            t = step / steps
            weights = (
                (-t + 2 * t**2 - t**3) / 2,
                (2 - 5 * t**2 + 3 * t**3) / 2,
                (t + 4 * t**2 - 3 * t**3) / 2,
                (t**3 - t**2) / 2,
            )
            near = list(zip(weights, (a, b, c, d), strict=True))
            points.append(tuple(sum(w * k[axis] for w, k in near) for axis in (0, 1)))
    return [*points, knots[-1]]


def cylinder(name, radius, height, location, material, rotation=ORIGIN, edge=0.002):
    """Return a capped cylinder standing on @p location, rims rounded by @p edge."""
    edge = min(edge, radius / 2, height / 2)
    profile = [
        (0, 0),
        (radius - edge, 0),
        (radius, edge),
        (radius, height - edge),
        (radius - edge, height),
        (0, height),
    ]
    return lathe(name, profile, location, material, rotation, 40)


def ball(name, radius, location, material, squash=1.0):
    """Return a smooth sphere centred on @p location, scaled in z by @p squash."""
    arc = [math.pi * step / 32 for step in range(33)]
    profile = [(radius * math.sin(a), -radius * squash * math.cos(a)) for a in arc]
    return lathe(name, profile, location, material)


def sheet(name, surface, columns, rows, material, location=ORIGIN, rotation=ORIGIN):
    """Return the smooth patch @p surface(u, v) -> (x, y, z) over the unit square."""
    vertices = [
        surface(i / columns, j / rows)
        for j in range(rows + 1)
        for i in range(columns + 1)
    ]
    stride = columns + 1
    faces = [
        (
            j * stride + i,
            j * stride + i + 1,
            (j + 1) * stride + i + 1,
            (j + 1) * stride + i,
        )
        for j in range(rows)
        for i in range(columns)
    ]
    return place(name, mesh(name, vertices, faces, True), material, location, rotation)


def prism(name, outline, depth, location, material, rotation=ORIGIN, edge=0.0):
    """Extrude @p outline, (x, z) points in metres, by @p depth along y, centred."""
    count = len(outline)
    vertices = [(x, side * depth / 2, z) for side in (-1, 1) for x, z in outline]
    faces = [tuple(range(count)), tuple(range(count, 2 * count))]
    for step in range(count):
        after = (step + 1) % count
        faces.append((step, after, count + after, count + step))
    item = place(name, mesh(name, vertices, faces), material, location, rotation)
    return bevel(item, edge, 3) if edge > 0 else item


def tube(name, points, radius, material, location=ORIGIN, rotation=ORIGIN, soft=True):
    """Return a round wire of @p radius through @p points; soft bends it smoothly."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = radius
    curve.bevel_resolution = 3
    curve.use_fill_caps = True
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(len(points) - 1)
    handle = "AUTO" if soft else "VECTOR"
    for knot, point in zip(spline.bezier_points, points, strict=True):
        knot.co = point
        knot.handle_left_type = knot.handle_right_type = handle
    return place(name, curve, material, location, rotation)


def lettering(name, text, size, tube_radius, material, location, rotation):
    """Return @p text drawn as outline tubes, letters @p size metres high."""
    curve = bpy.data.curves.new(name, "FONT")
    curve.body = text
    curve.size = size
    curve.align_x = "CENTER"
    curve.align_y = "CENTER"
    curve.space_line = 0.85
    curve.fill_mode = "NONE"
    curve.bevel_depth = tube_radius
    return place(name, curve, material, location, rotation)


def copy(item, location, rotation=ORIGIN, material=None):
    """Return another object that shares the mesh of @p item, optionally recoloured."""
    twin = item.copy()
    twin.location = location
    twin.rotation_euler = rotation
    bpy.context.scene.collection.objects.link(twin)
    if material is not None:
        twin.material_slots[0].link = "OBJECT"
        twin.material_slots[0].material = material
    return twin


def gather(parts, location, rotation=ORIGIN):
    """Parent @p parts to a pivot at @p location, so that they move as one."""
    pivot = bpy.data.objects.new("pivot", None)
    bpy.context.scene.collection.objects.link(pivot)
    pivot.location = location
    pivot.rotation_euler = rotation
    for part in parts:
        part.parent = pivot
    return pivot
