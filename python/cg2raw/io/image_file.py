# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Renders and pictures of any format that OpenImageIO reads: one reader for all."""

import contextlib
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.io import dwa, image_spaces
from cg2raw.io.atomic_file import FilePath, utf8_path
from cg2raw.io.image_spaces import COMMAND, Remedies
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


@dataclass(frozen=True)
class Image:
    """The picture in a file, and what the file says of it.

    pixels : (H, W, 3) float32, or float16 where that was asked for, R, G, B of the
    whole display window; black where the file has no data. space : the name of the
    pixels' colour space; may be empty. chromaticities : x, y of red, green, blue and
    white, if the file has them. shot : Exif, as write_dng takes it. undone : the curve
    that was undone, "srgb" or "g2.2", empty if there was none. encoding : what the file
    says of it, where no curve was looked for."""

    path: str
    pixels: NDArray[np.floating[Any]]
    space: str
    chromaticities: tuple[float, ...] | None = None
    shot: dict[str, Any] = field(default_factory=dict)
    undone: str = ""
    encoding: _core.StatedEncoding | None = None
    layer: str = ""  # empty: unnamed R, G, B
    time_code: str = ""  # SMPTE, hh:mm:ss:ff
    compression: str = ""  # as OpenImageIO calls it: "zip", "none"


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
    undo: str | None = None,
    space: str | None = None,
    keep_half: bool = False,
    remedies: Remedies = COMMAND,
) -> Image:
    """Return the Image at @path, over black.

    layer : the name of one in a layered or multi-part file; None for the picture by the
    conventions of renderers (beauty_layer in scene_file.h).
    undo : which curves of pictures are undone. None: none, and check_rec709 says if
    there is one; else a word of Undo in encoding.h, and a file whose pixels are not
    scene-linear Rec.709 then (or RAW, by "srgb") is an error that names the remedies.
    space : the name of the pixels' colour space, if the file errs.
    keep_half : pixels that are half floats in the file remain float16: reading those of
    a compressed EXR takes half the time then.
    Raises ValueError saying what is wrong with the file, OSError."""
    path = str(path)
    with opened(path) as source:
        chosen, spec = chosen_layer(path, source, layer)
        if space is not None:
            image_spaces.state(spec, space)
        chromaticities = spec.getattribute("chromaticities")
        curve = None
        try:
            said = image_spaces.encoding_of(spec, takes_raw=undo == "srgb")
            if undo is not None:
                curve = image_spaces.curve_of(said, undo, remedies)
                check_primaries_of(said, chromaticities)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        decoder = image_spaces.decoder_of(spec, chosen, curve)
        channels = chosen.channels + [chosen.alpha] * decoder.needs_alpha
        pixels = read_pixels(path, source, spec, channels, decoder, keep_half)
    undone = curve.name if curve else ""
    return Image(
        path=path,
        pixels=pixels,
        space="" if undone else said.space,
        chromaticities=tuple(chromaticities) if chromaticities else None,
        shot=shot_of(spec),
        undone=undone,
        encoding=said if undo is None else None,
        layer=chosen.name,
        time_code=spec.get_string_attribute("smpte:TimeCode"),
        compression=spec.get_string_attribute("compression"),
    )


def read_plane(path: FilePath) -> FloatImage:
    """Return (H, W) float32 of the first channel at @path, its whole display window."""
    with opened(path) as source:
        check_size(path, source.spec())
        plane: FloatImage = read_pixels(path, source, source.spec(), [0])[..., 0]
        return plane


def image_size(path: FilePath, layer: str | None = None) -> tuple[int, int]:
    """Return (H, W) of the picture at @path, by the headers; layer : as of read_image.

    Raises ValueError, OSError."""
    with opened(path) as source:
        _, spec = chosen_layer(path, source, layer)
        return spec.full_height, spec.full_width


def has_integers(path: FilePath) -> bool:
    """Return whether a file has whole numbers, which a curve may encode."""
    with opened(path) as source:
        return image_spaces.is_integer(source.spec())


def check_rec709(image: Image) -> None:
    """Raise ValueError unless an Image is scene-linear Rec.709, and says so."""
    if image.encoding is None:  # it was checked when it was read
        return
    try:
        image_spaces.curve_of(image.encoding, "none", COMMAND)
        check_primaries_of(image.encoding, image.chromaticities)
    except ValueError as error:
        raise ValueError(f"{image.path}: {error}") from None


def check_primaries_of(
    said: _core.StatedEncoding, chromaticities: Sequence[float] | None
) -> None:
    """Raise ValueError for primaries that are not those of the stated encoding."""
    if chromaticities:
        image_spaces.check_primaries(chromaticities, said.space)


def chosen_layer(
    path: FilePath, source: Any, layer: str | None
) -> tuple[_core.SceneLayer, Any]:
    """Return (SceneLayer, ImageSpec) of the picture; @source is at its part."""
    specs = specs_of(source)
    try:
        if len(specs) == 1:
            check_flat(specs[0])
        names = [(part_name(spec), spec.channelnames) for spec in specs]
        if names[0][1] == ("Y",) and specs[0].get_string_attribute("raw:FilterPattern"):
            raise ValueError(_core.raw_already)  # a DNG's mosaic in another format
        data = [name for spec in specs for name in cryptomatte_names(spec)]
        chosen = _core.beauty_layer(names, layer or "", data=data)
        spec = specs[chosen.part]
        check_flat(spec)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    check_size(path, spec)
    source.seek_subimage(chosen.part, 0)
    return chosen, spec


def specs_of(source: Any) -> list[Any]:
    """Return the ImageSpec of each image in a file."""
    specs = [source.spec()]
    while source.seek_subimage(len(specs), 0):
        specs.append(source.spec())
    return specs


def part_name(spec: Any) -> str:
    """Return the name of a part of a multi-part OpenEXR file; may be empty."""
    return str(spec.get_string_attribute("oiio:subimagename"))


def cryptomatte_names(spec: Any) -> list[str]:
    """Return the names that layers of a Cryptomatte start with."""
    return [
        str(said.value)
        for said in spec.extra_attribs
        if said.name.startswith("cryptomatte/") and said.name.endswith("/name")
    ]


def check_flat(spec: Any) -> None:
    """Raise ValueError for an image that is not flat."""
    if spec.deep or spec.depth > 1:
        raise ValueError(
            "deep and volume images cannot become a DNG: flatten first "
            "(oiiotool --flatten)"
        )


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


def shot_of(spec: Any) -> dict[str, Any]:
    """Return the Exif of an image, and its place in a shot, as write_dng takes it."""
    text, number = spec.get_string_attribute, spec.get_float_attribute
    date = text("Exif:DateTimeOriginal") or text("DateTime")
    return {
        "exposure_time": number("ExposureTime"),
        "f_number": number("FNumber"),
        "focal_length": number("Exif:FocalLength"),
        "date_time_original": date,
        "artist": text("Artist"),
        "copyright": text("Copyright"),
        "description": text("ImageDescription"),
        "lens_model": text("Exif:LensModel"),
        "orientation": spec.get_int_attribute("Orientation", 1),
        "pixel_aspect": pixel_aspect_of(spec),
        "frame_rate": frame_rate_of(spec),
        "time_code": time_code_of(spec),
        "reel_name": text("reelName") or text("openexr:reelName"),
        "camera_label": text("cameraLabel") or text("openexr:cameraLabel"),
    }


def pixel_aspect_of(spec: Any) -> float:
    """Return width over height of an image's pixels; 0 if it says nothing of it."""
    number = spec.get_float_attribute
    # Pixels per length: the wider they are, the fewer.
    x, y = float(number("XResolution")), float(number("YResolution"))
    return float(number("PixelAspectRatio")) or (y / x if x else 0.0)


def frame_rate_of(spec: Any) -> str:
    """Return the frames per second that an image says, empty if it says nothing that
    makes sense."""
    try:
        return _core.frame_rate_text(spec.get_string_attribute("FramesPerSecond"))
    except ValueError:
        return ""


def time_code_of(spec: Any) -> int | str:
    """Return the SMPTE time code of an image, packed or a text; empty: none."""
    code = spec.getattribute("smpte:TimeCode")
    if isinstance(code, tuple):
        return int(code[0])
    try:
        return _core.time_code_text(str(code)) if code else ""
    except ValueError:
        return ""


def stated_shot(path: FilePath, layer: str | None = None) -> dict[str, Any]:
    """Return what the header of a file says, as shot_of does.

    layer : as of read_image; that it is there is checked only if it is not None.
    Raises ValueError, OSError."""
    with opened(path) as source:
        spec = source.spec() if layer is None else chosen_layer(path, source, layer)[1]
        return shot_of(spec)
