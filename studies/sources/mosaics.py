# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames of RAW mosaics, by what their files say: DNGs that the plugin wrote of
renders, and photographs.

A frame has in each of its blocks of 2x2 pixels the values of the mosaic's four sites,
so that what studies.tasks.denoising takes of it is the mosaic itself."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor, register_oiio_plugin
from cg2raw.io.raw_file import open_raw
from cg2raw.oiio.openimageio import openimageio
from studies.cameras import Camera
from studies.sources.exposures import by_exposure, matching
from studies.sources.frames import Frames, Image
from studies.sources.ours import drawn
from studies.sources.sets import Material, Sources

Planes = NDArray[np.float32]  # (4, h, w): sites of RGGB, row by row; black 0, white 1
ARRAYS, FILES = "ours, match, DN", "ours, match, DNG files"
# The frame, and the levels of an RGGB file that states none. Source: the settings of
# its repository's own pipeline, github.com/mushfiqulalam/isp at 6fc30fc.
STATED = {"frames.npz": ("DSC_1339_768x512_rggb.raw", 600.0, 15520)}
PHOTOGRAPHS = {  # below the folder of camera data
    "Canon 550D, a colour chart": "real/canon550d_colorchart_tinydng.dng",
    "GoPro Hero6": "real/Hero6_GOPR0024.dng",
    "GoPro Fusion": "real/Fusion_GPFR7066.dng",
    "Blackmagic Pocket": "real/bmpcc_twelvemonkeys.dng",
    "Nikon D1": "real/nikon_d1_imagemeta.nef",
    "Nikon, 768x512": "real2/nikon_scene/frames.npz",
}


def by_file(
    found: Material, camera: Camera, seed: int, translator: None = None
) -> Sources:
    """Return sources of by_exposure(), and "ours, match" once more as DN: of arrays,
    and of DNGs that the plugin wrote of the renders and the reader read back."""
    told, count = camera.told(found.captures.neutrals), len(found.as_rendered)
    lights = drawn(count, seed, "measured")
    made = by_exposure(found, camera, seed)

    def of_arrays() -> Frames:
        frames = made["ours, match"]()
        planes = [
            sites(told.signal_from_raw(told.raw_from_signal(told.mosaic(image))))
            for image in frames.images
        ]
        return Frames([image_of(own) for own in planes], frames.neutrals)

    def of_files() -> Frames:
        neutrals = np.array([told.illuminant(word).neutral for word in lights])
        with TemporaryDirectory() as folder:
            match = Path(folder) / "match.json"
            fields = matching(told, found.captures, found.as_rendered).fields()
            match.write_text(json.dumps(fields))
            exposure: dict[str, str | int] = {
                "exposure": f"match:{match}",
                "seed": seed,
            }
            planes = written_and_read(
                Path(folder), found.as_rendered, told, lights, exposure
            )
        return Frames([image_of(own) for own in planes], neutrals)

    return {**made, ARRAYS: of_arrays, FILES: of_files}


def written_and_read(
    folder: Path,
    images: Sequence[Image],
    sensor: Sensor,
    lights: Sequence[str],
    settings: Mapping[str, str | int],
) -> list[Planes]:
    """Return what OpenImageIO with the plugin writes of renders (H, W, 3), without
    noise, and cg2raw reads of the DNGs.

    Raises ValueError without a plugin for this OpenImageIO, and for what it refuses."""
    register_oiio_plugin()
    oiio = openimageio()
    profile = folder / "sensor.json"
    profile.write_text(sensor.to_json())
    planes = []
    for frame, (image, word) in enumerate(zip(images, lights, strict=True)):
        path = str(folder / "frame.dng")
        spec = oiio.ImageSpec(*image.shape[1::-1], 3, "float")
        own = {"sensor": str(profile), "illuminant": word, "frame": frame}
        without = {"effects": "none", "preview": 0}
        for name, value in {**own, **without, **settings}.items():
            spec.attribute(f"dng:{name}", value)
        output = oiio.ImageOutput.create(path)
        done = output and output.open(path, spec) and output.write_image(image)
        if not (done and output.close()):
            raise ValueError(output.geterror() if output else oiio.geterror())
        planes.append(planes_of(path))
    return planes


def planes_of(path: str) -> Planes:
    """Return the sites of a RAW file, by its own phase and levels.

    Raises ValueError for a file that does not state them, or is no Bayer mosaic."""
    stated = STATED.get(Path(path).name)
    raw = open_raw(path, stated[0] if stated else None)
    header = raw.header
    cfa, black, white = header.cfa, header.black_level, header.white_level
    if stated:
        cfa, black, white = "RGGB", stated[1:2], stated[2]
    if cfa is None or black is None or white is None or sorted(cfa) != list("BGGR"):
        raise ValueError(f"{path}: states no Bayer mosaic and levels")
    row, column = divmod(cfa.index("R"), 2)
    plane = raw.mosaic()[row:, column:].astype(np.float64)
    level = float(np.mean(black))
    return sites(((plane - level) / (white - level)).astype(np.float32))


def photographs(
    data: Path, bin_of: int, size: int, most: int
) -> dict[str, list[Image]]:
    """Return frames of 2 size x 2 size pixels of each of PHOTOGRAPHS, side by side from
    the middle outwards, at most so many.

    bin_of : so many sites of a colour in each direction are one, so that the
    photograph's own noise is less by as much. Raises ValueError, also for a file that
    is missing."""
    found = {}
    for name, path in photograph_files(data).items():
        small = binned(planes_of(str(path)), bin_of)
        rows, columns = (side // size for side in small.shape[1:])
        corners = [
            (top * size, left * size) for top in range(rows) for left in range(columns)
        ]
        middle = np.array(small.shape[1:]) / 2 - size / 2
        corners.sort(key=lambda corner: float(np.hypot(*(np.array(corner) - middle))))
        found[name] = [
            image_of(small[:, top : top + size, left : left + size])
            for top, left in corners[:most]
        ]
    return found


def photograph_files(data: Path) -> dict[str, Path]:
    """Return the files of PHOTOGRAPHS. Raises ValueError for one that is missing."""
    found = {name: data / file for name, file in PHOTOGRAPHS.items()}
    for name, path in found.items():
        if not path.exists():
            raise ValueError(f"{path}: is missing: no photograph of {name}")
    return found


def binned(planes: Planes, size: int) -> Planes:
    """Return means of size x size sites of each plane."""
    height, width = (side // size for side in planes.shape[1:])
    kept = planes[:, : height * size, : width * size]
    blocks = kept.reshape(4, height, size, width, size)
    return np.asarray(blocks.mean(axis=(2, 4)), np.float32)


def sites(mosaic: Image) -> Planes:
    """Return the Planes of a mosaic (H, W) of RGGB, less an odd row or column."""
    height, width = (side // 2 * 2 for side in mosaic.shape)
    even = mosaic[:height, :width]
    return np.stack([even[row::2, column::2] for row in (0, 1) for column in (0, 1)])


def image_of(planes: Planes) -> Image:
    """Return (2 h, 2 w, 3) whose sites of RGGB are the planes."""
    red, first, second, blue = (
        np.repeat(np.repeat(plane, 2, axis=0), 2, axis=1) for plane in planes
    )
    green = (first + second) / 2
    green[0::2, 1::2], green[1::2, 0::2] = planes[1], planes[2]
    return np.stack([red, green, blue], axis=-1)
