# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders and pictures of any format that OpenImageIO reads: one reader for all."""

import contextlib
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.io import dwa, image_facts
from cg2raw.io.atomic_file import FilePath, utf8_path
from cg2raw.oiio.openimageio import one_line, openimageio
from cg2raw.system import check_readable

SIDES = (2, 65535)  # of a RAW file, pixels
# Of RAW files that OpenImageIO reads as their preview, or as LibRaw develops them.
RAW_ENDINGS = (
    *(".3fr", ".arw", ".cr2", ".cr3", ".crw", ".dcr", ".dng", ".erf", ".fff", ".gpr"),
    *(".iiq", ".kdc", ".mef", ".mos", ".mrw", ".nef", ".nrw", ".orf", ".pef", ".raf"),
    *(".rw2", ".rwl", ".sr2", ".srf", ".srw", ".x3f"),
    *(".fits", ".fit", ".fts", ".npy", ".npz"),
)
ROWS = 256  # that are read at a time; the most that EXR compresses together (DWAB)


def typed(name: str, value: str) -> str:
    """Return an option as it is typed on a command line."""
    return f"--{name} {value}".rstrip()


COMMAND = image_facts.dialect(typed)


@dataclass(frozen=True)
class Image:
    """The picture in a file, and what the file says of it.

    pixels : (H, W, 3) float32, R, G, B of the whole display window; black where the
    file has no data. undone : the curve that was undone, "srgb" or "g2.2", empty if
    there was none."""

    path: str
    pixels: NDArray[np.floating[Any]]
    shot: _core.Shot
    undone: str = ""
    layer: str = ""  # empty: unnamed R, G, B


@contextlib.contextmanager
def opened(path: FilePath) -> Generator[Any]:
    """Yield the ImageInput of @path. Raises ValueError, OSError.

    Its numbers are the file's: colour is not multiplied by an alpha beside it."""
    check_readable(path)  # OpenImageIO's own messages do not tell why it cannot
    oiio = openimageio()
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    with utf8_path(path) as way:
        if str(path).lower().endswith(RAW_ENDINGS) or _core.is_dng(way):
            raise ValueError(f"{path}: {_core.raw_already}")
        source = oiio.ImageInput.open(way, config)
        if source is None:
            raise ValueError(f"{way}: {one_line(oiio.geterror())}")
        with contextlib.closing(source):
            yield source


def read_image(
    path: FilePath,
    layer: str | None = None,
    undo: str = "stated",
    space: str | None = None,
    dialect: _core.Dialect = COMMAND,
    keep_half: bool = False,
) -> Image:
    """Return the Image at @path, scene-linear Rec.709 over black.

    layer : the name of one in a layered or multi-part file; None for the picture by the
    conventions of renderers (beauty_layer in scene_file.h).
    undo : which curves of pictures are undone: a word of Undo in encoding.h.
    space : the name of the pixels' colour space, if the file errs.
    Raises ValueError saying what is wrong with the file, and what to do in the words of
    @dialect; OSError. keep_half : as of read_picture."""
    options = _core.ExportOptions({"layer": layer or ""}, dialect, undo)
    with opened(path) as source:
        picture, spec = resolved(
            path,
            source,
            lambda facts: _core.resolve_picture(facts, options, dialect),
            space,
        )
        pixels = read_picture(path, source, spec, picture, keep_half)
    return Image(
        path=str(path),
        pixels=pixels,
        shot=picture.shot,
        undone=picture.undone,
        layer=picture.layer.name,
    )


def resolved(
    path: FilePath,
    source: Any,
    rule: Callable[[_core.ImageFacts], _core.Export],
    space: str | None,
    **known: Any,
) -> tuple[_core.Export, Any]:
    """Return (what @rule decides of a file, the ImageSpec of its picture).

    source : at the part of the picture then. space : as of read_image. known : more
    facts. Raises ValueError."""
    specs = specs_of(source)
    if space is not None:
        for spec in specs:
            image_facts.state(spec, space)
    try:
        decided = rule(image_facts.facts(specs, str(path), **known))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    spec = specs[decided.layer.part]
    check_size(path, spec)
    source.seek_subimage(decided.layer.part, 0)
    return decided, spec


def read_picture(
    path: FilePath,
    source: Any,
    spec: Any,
    picture: _core.Export,
    keep_half: bool = False,
) -> NDArray[np.floating[Any]]:
    """Return the pixels of Image, of what is decided of a file.

    keep_half : pixels that are half floats in the file remain float16: reading those of
    a compressed EXR takes half the time then."""
    layer, decoder = picture.layer, picture.decoder
    channels = layer.channels + [layer.alpha] * decoder.needs_alpha
    return read_pixels(path, source, spec, channels, decoder, keep_half)


def read_plane(path: FilePath) -> FloatImage:
    """Return (H, W) float32 of the first channel at @path, its whole display window."""
    with opened(path) as source:
        check_size(path, source.spec())
        plane: FloatImage = read_pixels(path, source, source.spec(), [0])[..., 0]
        return plane


def image_size(path: FilePath, layer: str | None = None) -> tuple[int, int]:
    """Return (H, W) of the picture at @path, by the headers; layer : as of read_image.

    Raises ValueError, OSError."""
    options = _core.ExportOptions({"layer": layer or ""}, COMMAND)
    with opened(path) as source:
        specs = specs_of(source)
        try:
            found = _core.picture_layer(image_facts.facts(specs), options, COMMAND)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    spec = specs[found.part]
    check_size(path, spec)
    return spec.full_height, spec.full_width


def has_integers(path: FilePath) -> bool:
    """Return whether a file has whole numbers, which a curve may encode."""
    with opened(path) as source:
        return _core.levels_of(str(source.spec().format)) != 0


def specs_of(source: Any) -> list[Any]:
    """Return the ImageSpec of each image in a file."""
    specs = [source.spec()]
    while source.seek_subimage(len(specs), 0):
        specs.append(source.spec())
    return specs


def check_size(path: FilePath, spec: Any) -> None:
    """Raise ValueError for a size that no RAW file has."""
    least, most = SIDES
    width, height = spec.full_width, spec.full_height
    if not all(least <= side <= most for side in (width, height)):
        raise ValueError(
            f"{path}: is {width}x{height} pixels: a RAW file has {least} to {most} on "
            "each side"
        )


def read_pixels(
    path: FilePath,
    source: Any,
    spec: Any,
    channels: Sequence[int],
    decoder: _core.Decoder | None = None,
    keep_half: bool = False,
) -> NDArray[np.floating[Any]]:
    """Return (H, W, C) float32, or float16, of the display window, a few rows at a
    time: numbers, or, by a @decoder, light of R, G, B; alpha comes last."""
    dwa.choose_decoder(source, spec)
    decode = None if decoder is None or decoder.is_identity else decoder.decode
    half = keep_half and decode is None and are_half(spec, channels)
    shape = spec.full_height, spec.full_width, 3 if decode else len(channels)
    whole = np.zeros(shape, np.float16 if half else np.float32)
    kind = openimageio().HALF if half else openimageio().FLOAT
    for rows, cols, part in visible_rows(path, source, spec, channels, kind):
        whole[rows, cols] = decode(part) if decode else part
    return whole


def are_half(spec: Any, channels: Sequence[int]) -> bool:
    """Return whether all of some channels are half floats in the file."""
    return all(str(spec.channelformat(channel)) == "half" for channel in channels)


def visible_rows(
    path: FilePath, source: Any, spec: Any, channels: Sequence[int], kind: Any
) -> Iterator[tuple[slice, slice, NDArray[Any]]]:
    """Yield (rows, cols, (h, w, C) pixels) of the display window where there are data.

    The pixels are as read_rows gives them."""
    left, top = spec.x - spec.full_x, spec.y - spec.full_y
    cols = slice(max(left, 0), min(left + spec.width, spec.full_width))
    first, last = max(top, 0), min(top + spec.height, spec.full_height)
    if first >= last or cols.start >= cols.stop:
        raise ValueError(
            f"{path}: its data window, {spec.width}x{spec.height} at "
            f"{spec.x},{spec.y}, lies outside its display window, "
            f"{spec.full_width}x{spec.full_height} at {spec.full_x},{spec.full_y}: "
            "nothing would be seen (oiiotool --origin, or --fullpixels)"
        )
    step = spec.tile_height or ROWS
    for row in range((first - top) // step * step, last - top, step):
        count = min(step, spec.height - row)
        part = read_rows(path, source, spec, row, count, channels, kind)
        begin, end = max(first - top - row, 0), min(last - top - row, count)
        rows = slice(top + row + begin, top + row + end)
        yield rows, cols, part[begin:end, cols.start - left : cols.stop - left]


def read_rows(
    path: FilePath,
    source: Any,
    spec: Any,
    row: int,
    count: int,
    channels: Sequence[int],
    kind: Any,
) -> NDArray[Any]:
    """Return (count, W, C) pixels of rows of the data window, of OpenImageIO's @kind.

    Rows that are compressed together are read together, so that no whole copy is
    made: at most 256 in OpenEXR, or a row of tiles."""
    top, least, most = spec.y + row, min(channels), max(channels) + 1
    try:
        if spec.tile_height:
            box = (spec.x, spec.x + spec.width, top, top + count, spec.z, spec.z + 1)
            pixels = source.read_tiles(*box, least, most, kind)
        else:
            pixels = source.read_scanlines(top, top + count, spec.z, least, most, kind)
    except RuntimeError as error:  # it may start no thread
        raise OSError(f"{path}: cannot be read: {one_line(str(error))}") from None
    if pixels is None:
        raise ValueError(f"{path}: {one_line(source.geterror())}")
    pixels = np.reshape(pixels, (count, spec.width, most - least))
    in_order = list(channels) == list(range(least, most))
    return pixels if in_order else pixels[..., [c - least for c in channels]]
