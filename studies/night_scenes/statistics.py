# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How much a folder's frames differ: colour of their light, brightness, likeness.

Needs cg2raw, and so the project's own environment, not Blender's."""

import json
from pathlib import Path

import numpy as np

from .folder import Refused, name

SENSOR, LIGHT = "samsung-s20fe", "D65"  # whose 105 night neutrals the paper used
GOAL_SHARE, GOAL_STOPS = 0.8, 3.0
THUMBNAIL = (9, 16)  # rows, columns
FLOOR = 0.002  # scene linear; darker parts of thumbnails count as equal
ALIKE = 0.5  # stops rms between thumbnails; below this two frames are near-duplicates
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709


def frames(folder):
    """Yield (index, pixels (H, W, 3) float32, description) of a folder's frames.

    Raises Refused for a folder without frames."""
    from cg2raw.io.image_file import read_image

    paths = sorted(Path(folder).glob("night_*.exr"))
    if not paths:
        raise Refused(f"{folder}: holds no frames (night_0000.exr ...)")
    for path in paths:
        text = path.with_suffix(".json")
        described = json.loads(text.read_text()) if text.exists() else {}
        yield int(path.stem.rpartition("_")[2]), read_image(path).pixels, described


def thumbnail(pixels):
    """Return (9, 16, 3) means of blocks, in stops about their own mean."""
    for axis, count in enumerate(THUMBNAIL):
        edges = np.arange(count) * pixels.shape[axis] // count
        sizes = np.diff([*edges, pixels.shape[axis]])
        shape = [-1 if k == axis else 1 for k in range(3)]
        pixels = np.add.reduceat(pixels, edges, axis=axis) / sizes.reshape(shape)
    stops = np.log2(np.maximum(pixels, 0) + FLOOR)
    return stops - stops.mean()


def neutral(sensor, rgb, light=LIGHT):
    """Return (R/G, B/G) of a scene-linear colour as @sensor sees it under a light."""
    pixel = np.asarray(rgb, np.float32).reshape(1, 1, 3)
    seen = sensor.to_camera(pixel, illuminant=light, highlights=False)[0, 0]
    return seen[0] / seen[1], seen[2] / seen[1]


def hull(points):
    """Return the corners of the convex hull, anticlockwise. (N, 2) -> (M, 2)

    Method: A. M. Andrew, Information Processing Letters 9(5), 1979."""
    ordered = sorted({tuple(map(float, point)) for point in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def half(sequence):
        chain = []
        for point in sequence:
            while len(chain) > 1 and turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def turn(a, b, c):
    """Return twice the area of a triangle, above 0 if its corners turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def area(polygon):
    """Return a polygon's area, 0 for less than a triangle."""
    if len(polygon) < 3:
        return 0.0
    x, y = np.asarray(polygon).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def common(polygon, window):
    """Return what a polygon shares with a convex one whose corners turn left.

    Method: Sutherland and Hodgman, Communications of the ACM 17(1), 1974."""
    result = [tuple(point) for point in polygon]
    for start, end in zip(window, np.roll(window, -1, axis=0), strict=True):
        before, result = result, []
        for a, b in zip(before, before[1:] + before[:1], strict=True):
            side_a, side_b = turn(start, end, a), turn(start, end, b)
            if side_a >= 0:
                result.append(a)
            if side_a * side_b < 0:
                t = side_a / (side_a - side_b)
                result.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
    return result


def share(points, window):
    """Return which share of the area of @window's hull the hull of @points covers."""
    window, points = hull(window), hull(points)
    if len(points) < 3:
        return 0.0
    return area(common(points, window)) / area(window)


def closest(thumbnails):
    """Return (rms difference in stops, place, place) of the two most alike."""
    flat = np.array([each.ravel() for each in thumbnails])
    if len(flat) < 2:
        return np.inf, 0, 0
    square = (flat**2).sum(axis=1)
    apart = square[:, None] + square[None] - 2 * flat @ flat.T
    np.fill_diagonal(apart, np.inf)
    first, second = np.unravel_index(np.argmin(apart), apart.shape)
    rms = np.sqrt(max(apart[first, second], 0.0) / flat.shape[1])
    return float(rms), int(first), int(second)


def measure(folder):
    """Return the numbers of a folder by name."""
    import cg2raw

    sensor = cg2raw.Sensor(SENSOR)
    night = sensor.illuminants["hull"]
    indices, neutrals, converted, medians, thumbnails = [], [], [], [], []
    kinds = {}
    for index, pixels, described in frames(folder):
        pixels = np.asarray(pixels, np.float64)
        indices.append(index)
        mean = np.clip(pixels, 0, 1).mean(axis=(0, 1))
        neutrals.append(neutral(sensor, mean))
        converted.append(neutral(sensor, mean, f"sample:{index}"))
        medians.append(float(np.median(pixels @ LUMINANCE)))
        thumbnails.append(thumbnail(pixels))
        kind = described.get("scene", {}).get("kind", "unknown")
        kinds[kind] = kinds.get(kind, 0) + 1
    apart, first, second = closest(thumbnails)
    return {
        "frames": len(indices),
        "kinds": kinds,
        "share": share(neutrals, night),
        "share of Rec.709": share([neutral(sensor, c) for c in np.eye(3)], night),
        "share converted": share(converted, night),
        "medians": (min(medians), max(medians)),
        "stops": float(np.log2(max(medians) / max(min(medians), 1e-6))),
        "stops of 90 %": float(np.log2(np.divide(*np.quantile(medians, (0.95, 0.05))))),
        "closest": apart,
        "pair": (indices[first], indices[second]),
        "neutrals": neutrals,
    }


def report(folder):
    """Return the lines that say how varied a folder's frames are."""
    found = measure(folder)
    low, high = found["medians"]
    first, second = map(name, found["pair"])
    kinds = ", ".join(f"{count} {kind}" for kind, count in found["kinds"].items())
    return "\n".join(
        (
            f"frames            {found['frames']} ({kinds})",
            f"mean colours      cover {found['share converted']:.0%} of the hull of "
            f"{SENSOR}'s night neutrals, each frame under a drawn light as "
            f"training data are (goal {GOAL_SHARE:.0%})",
            f"                  and {found['share']:.0%} by their own colour alone, "
            f"seen under {LIGHT}; Rec.709 can reach {found['share of Rec.709']:.0%}",
            f"median luminance  {low:.4f} to {high:.4f}: {found['stops']:.1f} stops, "
            f"{found['stops of 90 %']:.1f} of them between 5 % and 95 % of the frames "
            f"(goal {GOAL_STOPS:.0f})",
            f"most alike        {first} and {second}: {found['closest']:.2f} stops rms "
            f"of 16x9 thumbnails (near-duplicates are below {ALIKE})",
        )
    )
