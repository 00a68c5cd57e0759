# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sections of FITS images: where the picture is, its overscan, and its place.

Conventions: IRAF, ccdred's guide ("Notes on the keywords", TRIMSEC, BIASSEC, DATASEC,
CCDSEC), and NOAO, "Mosaic Data Structures" (DETSEC, CCDSUM): [first column:last,
first row:last], from 1 on, both bounds inclusive; bounds that fall are mirrored.
"""

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.raw_header import Levels
from cg2raw.normal import robust_deviation

SECTION = re.compile(r"\[\s*(-?\d+)\s*:\s*(-?\d+)\s*,\s*(-?\d+)\s*:\s*(-?\d+)\s*\]")
PICTURES = ("TRIMSEC", "DATASEC")  # the first that is there counts
PLACES = ("DETSEC", "CCDSEC")
ROOM = 6.0  # sigma of the overscan, that black must lie above 0 DN
CLIPPED = 4.0  # sigma; pixels of the overscan further off are no bias

Plane = NDArray[np.float64]


@dataclass(frozen=True)
class Section:
    """A rectangle of a stored image, px from its first pixel on. mirrored : (rows,
    columns) that are read backwards."""

    keyword: str
    top: int
    left: int
    height: int
    width: int
    mirrored: tuple[bool, bool] = (False, False)

    @property
    def shape(self) -> tuple[int, int]:
        return self.height, self.width

    @property
    def slices(self) -> tuple[slice, slice]:
        return (
            slice(self.top, self.top + self.height),
            slice(self.left, self.left + self.width),
        )

    def lies_in(self, shape: tuple[int, int]) -> bool:
        """Return whether all of it is in an image of (H, W)."""
        below, beyond = self.top + self.height, self.left + self.width
        return (
            min(self.top, self.left) >= 0 and below <= shape[0] and beyond <= shape[1]
        )

    def meets(self, other: "Section") -> bool:
        """Return whether two have a pixel in common."""
        return (
            max(self.top, other.top)
            < min(self.top + self.height, other.top + other.height)
        ) and (
            max(self.left, other.left)
            < min(self.left + self.width, other.left + other.width)
        )


@dataclass(frozen=True)
class Part:
    """What one amplifier read: its picture in the stored image, its overscan there, and
    where the picture lies among those of the others.

    hdu : number of the image in the file. name : of it, for messages."""

    hdu: int
    name: str
    picture: Section
    overscan: Section | None = None
    place: Section | None = None


def section_of(path: str, header: Any, keyword: str) -> Section | None:
    """Return the section that a keyword states; None if there is none. Raises
    ValueError for what is none."""
    text = header.get(keyword)
    if text is None or not str(text).strip():
        return None
    found = SECTION.fullmatch(str(text).strip())
    if not found:
        raise ValueError(
            f"{path}: {keyword} is {text}; must be a section such as [1:1024,1:512]"
        )
    x, beyond, y, below = map(int, found.groups())
    return Section(
        keyword,
        min(y, below) - 1,
        min(x, beyond) - 1,
        abs(below - y) + 1,
        abs(beyond - x) + 1,
        (below < y, beyond < x),
    )


def parts_of(
    path: str, hdu: int, name: str, header: Any, shape: tuple[int, int]
) -> tuple[list[Part], list[str]]:
    """Return (parts of one image, notes). Raises ValueError, naming the keyword, for
    sections that are not in the image or are not clear."""
    numbers = [n for n in range(1, 100) if f"BIASSEC{n}" in header]
    if numbers:
        parts = [
            part_of(path, Part(hdu, f"{name} {n}", whole(shape)), header, shape, f"{n}")
            for n in numbers
        ]
        return placed_by_columns(path, [part for part, _ in parts], shape), []
    part, notes = part_of(path, Part(hdu, name, whole(shape)), header, shape)
    return [part], notes


def whole(shape: tuple[int, int]) -> Section:
    """Return all of an image of (H, W)."""
    return Section("", 0, 0, *shape)


def part_of(
    path: str, part: Part, header: Any, shape: tuple[int, int], number: str = ""
) -> tuple[Part, list[str]]:
    """Return (a part with its sections, notes). number : of its keywords."""
    keywords = [keyword + number for keyword in PICTURES]
    stated = [section_of(path, header, keyword) for keyword in keywords]
    picture = next(filter(None, stated), None)
    bias = section_of(path, header, f"BIASSEC{number}")
    if bias and not picture:
        raise ValueError(
            f"{path}: {bias.keyword} says where overscan is, and neither "
            f"{' nor '.join(keywords)} where the picture is: add one"
        )
    if picture and picture.shape == shape and not (bias and bias.lies_in(shape)):
        trimmed = bias is not None or picture != replace(picture, top=0, left=0)
        words = "is trimmed already: its overscan is not in the file"
        return part, [words] if trimmed else []
    for section in filter(None, (picture, bias)):
        if not section.lies_in(shape):
            raise ValueError(
                f"{path}: {section.keyword} is {header[section.keyword]}, and the "
                f"image {shape[1]}x{shape[0]}: it must lie in the image"
            )
    if picture and bias and bias.meets(picture):
        raise ValueError(
            f"{path}: {bias.keyword} and {picture.keyword} overlap; overscan is no "
            "part of the picture"
        )
    return replace(part, picture=picture or part.picture, overscan=bias), []


def placed_by_columns(
    path: str, parts: Sequence[Part], shape: tuple[int, int]
) -> list[Part]:
    """Return parts of one image, placed side by side: rows and columns that no picture
    has are left out."""
    rows, cols = np.zeros(shape[0], np.intp), np.zeros(shape[1], np.intp)
    for part in parts:
        down, across = part.picture.slices
        rows[down] = cols[across] = 1
    row, col = np.cumsum(rows) - rows, np.cumsum(cols) - cols
    places = [
        replace(p.picture, top=int(row[p.picture.top]), left=int(col[p.picture.left]))
        for p in parts
    ]
    placed = [replace(p, place=at) for p, at in zip(parts, places, strict=True)]
    size_of(path, placed)
    return placed


def placed_on_sensor(
    path: str, part: Part, header: Any, shape: tuple[int, int]
) -> Part:
    """Return an image's part at the place on the sensor that DETSEC or CCDSEC states,
    with the picture that has its size."""
    stated = [section_of(path, header, keyword) for keyword in PLACES]
    place = next(filter(None, stated), None)
    if place is None:
        raise ValueError(
            f"{path}: image {part.name} has no {' or '.join(PLACES)}, which says where "
            "it lies among the others: choose one image"
        )
    right, down = binning_of(path, header)
    size = place.height // down, place.width // right
    sections = [section_of(path, header, keyword) for keyword in PICTURES]
    for picture in (part.picture, *filter(None, sections)):
        if picture.shape == size and picture.lies_in(shape):
            at = replace(
                place,
                top=place.top // down,
                left=place.left // right,
                height=size[0],
                width=size[1],
            )
            return replace(part, picture=picture, place=at)
    raise ValueError(
        f"{path}: {place.keyword} of image {part.name} is {size[1]}x{size[0]} pixels, "
        f"the picture {part.picture.width}x{part.picture.height}: they must agree"
    )


def binning_of(path: str, header: Any) -> tuple[int, int]:
    """Return how many columns and rows of the sensor a pixel is the sum of."""
    text = str(header.get("CCDSUM", "1 1"))
    found = re.fullmatch(r"\s*([1-9]\d*)\s+([1-9]\d*)\s*", text)
    if not found:
        raise ValueError(f"{path}: CCDSUM is {text}; must be two numbers such as 2 2")
    return int(found[1]), int(found[2])


def size_of(path: str, parts: Sequence[Part]) -> tuple[int, int]:
    """Return (H, W) of the picture that parts make. Raises ValueError unless each of
    its pixels is in one."""
    if len(parts) == 1:
        return parts[0].picture.shape
    places = [part.place for part in parts if part.place]
    top, left = min(p.top for p in places), min(p.left for p in places)
    height = max(p.top + p.height for p in places) - top
    width = max(p.left + p.width for p in places) - left
    covered = sum(p.height * p.width for p in places)
    pairs = [(a, b) for i, a in enumerate(places) for b in places[:i]]
    if covered != height * width or any(a.meets(b) for a, b in pairs):
        raise ValueError(
            f"{path}: {', '.join(part.name for part in parts)} do not make one picture "
            f"of {width}x{height} by {places[0].keyword}: they overlap or leave gaps; "
            "choose one image"
        )
    return height, width


def joined(
    path: str,
    parts: Sequence[Part],
    stored: Callable[[Part], Plane],
    levels: Levels | None,
) -> Plane:
    """Return (H, W) DN of the picture that parts make, in the order of their file.

    stored : (part) -> all of the image that it is in. levels : of the sensor; a part
    with overscan is moved to them."""
    planes = []
    for part in parts:
        dn = stored(part)
        plane = dn[part.picture.slices]
        if part.overscan is not None and levels is not None:
            plane = moved(path, plane, dn[part.overscan.slices], levels)
        planes.append(plane)
    if len(parts) == 1:
        return planes[0]
    size = size_of(path, parts)
    out = np.empty(size)
    places = [part.place for part in parts if part.place]
    top, left = min(p.top for p in places), min(p.left for p in places)
    for place, plane in zip(places, planes, strict=True):
        rows, cols = replace(place, top=place.top - top, left=place.left - left).slices
        up, back = place.mirrored
        out[rows, cols] = plane[:: -1 if up else 1, :: -1 if back else 1]
    return out


def moved(path: str, plane: Plane, overscan: Plane, levels: Levels) -> Plane:
    """Return a picture whose bias, the mean of its overscan, is the black level.

    It moves by whole DN, so that words stay words; saturated pixels stay so."""
    middle = np.median(overscan)
    sd = max(robust_deviation(overscan), 0.5)
    near = overscan[np.abs(overscan - middle) <= CLIPPED * sd]
    bias = float(near.mean())
    if levels.black < min(ROOM * sd, bias):
        raise ValueError(
            f"{os.path.basename(path)}: the overscan, {bias:.1f} DN with {sd:.1f} DN "
            f"of noise, is taken off, and a black level of {levels.black:g} DN leaves "
            "no room for noise below it: set black_level of the profile to "
            f"{bias:.0f}"
        )
    shifted = np.clip(plane + np.rint(levels.black - bias), 0, levels.white)
    return np.where(plane >= levels.white, plane, shifted)
