# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""People as low-poly figures, to be seen at a distance or against light. Metres."""

import math

from .library import geometry, group, materials, paint

SIDES = 10
SKIN = (0.30, 0.17, 0.11)
# Joints by pose, as shares of the height: (x, y, z); a figure faces -y.
# Feet, knees, elbows and hands: left, then right. What sits is moved
# down by "drop".
POSES = {
    "standing": {
        "feet": ((-0.06, -0.01, 0), (0.07, 0.01, 0)),
        "knees": ((-0.055, -0.01, 0.27), (0.06, 0.0, 0.27)),
        "elbows": ((-0.15, 0.01, 0.62), (0.15, 0.01, 0.62)),
        "hands": ((-0.14, -0.03, 0.47), (0.14, -0.04, 0.47)),
    },
    "walking": {
        "feet": ((-0.04, -0.15, 0), (0.04, 0.17, 0.02)),
        "knees": ((-0.045, -0.09, 0.27), (0.045, 0.03, 0.27)),
        "elbows": ((-0.14, 0.07, 0.63), (0.14, -0.04, 0.62)),
        "hands": ((-0.13, 0.08, 0.48), (0.13, -0.13, 0.52)),
    },
    "striding": {
        "feet": ((-0.04, -0.21, 0), (0.04, 0.22, 0.03)),
        "knees": ((-0.045, -0.13, 0.26), (0.045, 0.06, 0.27)),
        "elbows": ((-0.14, 0.10, 0.64), (0.14, -0.07, 0.63)),
        "hands": ((-0.13, 0.14, 0.50), (0.13, -0.18, 0.56)),
    },
    "sitting": {
        "feet": ((-0.06, -0.26, 0.20), (0.06, -0.24, 0.20)),
        "knees": ((-0.06, -0.25, 0.47), (0.06, -0.24, 0.47)),
        "elbows": ((-0.15, -0.03, 0.62), (0.15, -0.03, 0.62)),
        "hands": ((-0.09, -0.16, 0.58), (0.09, -0.17, 0.60)),
        "drop": 0.20,
    },
    "phone": {
        "feet": ((-0.06, 0.0, 0), (0.06, -0.03, 0)),
        "knees": ((-0.055, 0.0, 0.27), (0.055, -0.03, 0.27)),
        "elbows": ((-0.15, 0.01, 0.62), (0.14, -0.04, 0.62)),
        "hands": ((-0.14, -0.02, 0.47), (0.05, -0.16, 0.70)),
    },
}

# (z, half width, half depth) of rings: body, head and hair, in shares of the height.
BODY = (
    (0.52, 0.098, 0.068),
    (0.62, 0.088, 0.06),
    (0.74, 0.108, 0.066),
    (0.805, 0.112, 0.058),
    (0.845, 0.05, 0.042),
)
HEAD = (
    (0.82, 0.028, 0.03),
    (0.87, 0.036, 0.044),
    (0.91, 0.044, 0.056),
    (0.955, 0.043, 0.055),
    (0.985, 0.028, 0.034),
    (1.0, 0.006, 0.006),
)
HAIR = (
    (0.895, 0.046, 0.050),
    (0.95, 0.051, 0.060),
    (0.985, 0.038, 0.046),
    (1.006, 0.010, 0.010),
)


def limb(first, second, start, end):
    """Return (vertices, faces) of a tapered round limb between two points."""
    axis = [b - a for a, b in zip(first, second, strict=True)]
    length = math.sqrt(sum(c * c for c in axis)) or 1.0
    axis = [c / length for c in axis]
    other = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.8 else (0.0, 1.0, 0.0)
    u = cross(axis, other)
    size = math.sqrt(sum(c * c for c in u))
    u = [c / size for c in u]
    v = cross(axis, u)
    rings = ((-0.6 * start, 0.6), (0.0, 1.0), (length, 1.0), (length + 0.6 * end, 0.6))
    vertices = []
    for along, share in rings:
        radius = share * (start if along <= 0 else end)
        for step in range(SIDES):
            a = 2 * math.pi * step / SIDES
            c, s = radius * math.cos(a), radius * math.sin(a)
            vertices.append(
                tuple(
                    first[i] + axis[i] * along + u[i] * c + v[i] * s for i in range(3)
                )
            )
    return vertices, tube_faces(len(rings))


def tube_faces(rings):
    """Return the faces of @rings rings of SIDES points each, closed at both ends."""
    faces = [tuple(range(SIDES)), tuple(range((rings - 1) * SIDES, rings * SIDES))]
    for ring in range(rings - 1):
        for step in range(SIDES):
            after = (step + 1) % SIDES
            a, b = ring * SIDES, (ring + 1) * SIDES
            faces.append((a + step, a + after, b + after, b + step))
    return faces


def trunk(rings):
    """Return (vertices, faces) through ellipses (z, half width, half depth)."""
    vertices = [
        (
            w * math.cos(2 * math.pi * k / SIDES),
            d * math.sin(2 * math.pi * k / SIDES),
            z,
        )
        for z, w, d in rings
        for k in range(SIDES)
    ]
    return vertices, tube_faces(len(rings))


def cross(a, b):
    """Return the vector product."""
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def solid(name, pieces, height, material):
    """Join pieces, in shares of the height, to one smooth object."""
    vertices, faces = [], []
    for points, sides in pieces:
        start = len(vertices)
        vertices += [tuple(height * c for c in point) for point in points]
        faces += [tuple(start + k for k in face) for face in sides]
    data = geometry.mesh(name, vertices, faces, True)
    return geometry.place(name, data, material)


def figure(person):
    """Build one figure in its pose."""
    pose, height = POSES[person.pose], person.height
    legs, arms, shoes = limbs(pose)
    is_long = sum(person.coat) % 0.02 < 0.01 and "drop" not in pose
    hem = (0.36 if is_long else 0.47, 0.105, 0.075)
    solid("legs", legs, height, paint(person.trousers, 0.8))
    solid("coat", [trunk((hem, *BODY)), *arms], height, paint(person.coat, 0.75))
    solid("shoes", shoes, height, paint((0.012, 0.011, 0.010), 0.4))
    head_and_hands(pose, height)
    if person.pose == "phone":
        glow = materials.glow("phone", (0.6, 0.8, 1.0), 3.0)
        x, y, z = (height * c for c in pose["hands"][1])
        geometry.box("phone", (0.07, 0.01, 0.14), (x, y - 0.02, z + 0.05), glow, edge=0)
    if person.umbrella:
        umbrella(height, person)


def limbs(pose):
    """Return the pieces of legs, arms and shoes, in shares of the height."""
    legs, arms, shoes = [], [], []
    for side, sign in ((0, -1), (1, 1)):
        hip, knee = (sign * 0.05, 0, 0.51), pose["knees"][side]
        foot = pose["feet"][side]
        ankle = (foot[0], foot[1], foot[2] + 0.045)
        legs += [limb(hip, knee, 0.052, 0.036), limb(knee, ankle, 0.036, 0.026)]
        heel = (foot[0], foot[1], foot[2] + 0.02)
        toe = (foot[0], foot[1] - 0.075, foot[2] + 0.018)
        shoes.append(limb(heel, toe, 0.024, 0.018))
        shoulder, elbow = (sign * 0.105, 0, 0.80), pose["elbows"][side]
        arms.append(limb(shoulder, elbow, 0.034, 0.028))
        arms.append(limb(elbow, pose["hands"][side], 0.028, 0.020))
    return legs, arms, shoes


def head_and_hands(pose, height):
    """Build head, hair and hands."""
    hands = [
        limb(hand, (*hand[:2], hand[2] - 0.03), 0.02, 0.015) for hand in pose["hands"]
    ]
    solid("head", [trunk(HEAD), *hands], height, paint(SKIN, 0.6))
    hair = solid("hair", [trunk(HAIR)], height, paint((0.02, 0.014, 0.01), 0.7))
    hair.location = (0, 0.012 * height, 0)


def umbrella(height, person):
    """An open umbrella over the figure."""
    cloth = paint(person.coat, 0.5)
    top = height + 0.28
    geometry.cylinder("stick", 0.008, 0.8, (0.12, -0.1, top - 0.8), paint((0.02,) * 3))
    profile = [(0, 0), (0.25, -0.05), (0.45, -0.15), (0.56, -0.28), (0.555, -0.28),
               (0.44, -0.16), (0.24, -0.06), (0, -0.01)]  # fmt: skip
    geometry.lathe("umbrella", profile, (0.12, -0.1, top), cloth, segments=16)


def build(people):
    """Build all people of a scene."""
    for person in people:
        x, y, z = person.place
        drop = POSES[person.pose].get("drop", 0.0) * person.height
        with group((x, y, z - drop), person.turn):
            figure(person)
