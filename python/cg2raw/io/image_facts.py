# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a file says of its image, as the core's rules of an export take it."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cg2raw import _core
from cg2raw.oiio.openimageio import openimageio

REC709 = "lin_rec709"  # what messages call it
MOST_NUMBERS = 16  # of an attribute; profiles and pictures have more
Rows = list[tuple[float, float]]
# What files say of their pixels' encoding by other means than the name of a space.
OTHER_STATEMENTS = (
    "chromaticities",
    "colorInteropID",
    "ICCProfile:profile_description",
    "dpx:Transfer",
)


def dialect(
    option: Callable[[str, str], str], is_linear: str = f"--iscolorspace {REC709}"
) -> _core.Dialect:
    """Return how messages name options.

    option : (name, value) -> as it is typed. is_linear : what says that pixels are."""
    return _core.Dialect(option, is_rec709, REC709, is_linear)


def is_rec709(word: str) -> bool:
    """Return whether linear, the name of a space, or scene_linear, a role, is: OCIO's
    config knows."""
    config = openimageio().ColorConfig()
    role = config.getColorSpaceNameByRole("scene_linear") or REC709
    return _core.is_rec709_name(config.resolve(word) if word == "linear" else role)


def facts(
    specs: Sequence[Any],
    input_name: str = "",
    output_name: str = "",
    place: int | None = None,
    measured_light: Callable[[str, _core.SpectralChannels], Rows] | None = None,
) -> _core.ImageFacts:
    """Return the facts of a file whose images have these ImageSpecs."""
    parts = [
        (
            str(spec.get_string_attribute("oiio:subimagename")),
            list(spec.channelnames),
            str(spec.format),
            not spec.deep and spec.depth <= 1,
            dict(stated(spec)),
        )
        for spec in specs
    ]
    return _core.ImageFacts(
        parts,
        utf8(input_name),
        utf8(output_name),
        openimageio().VERSION,
        place,
        measured_light,
    )


def utf8(name: str) -> str:
    """Return a file's name with ? for what is not UTF-8."""
    return name.encode("utf-8", "replace").decode()


def stated(spec: Any) -> Iterator[tuple[str, str | Sequence[float]]]:
    """Yield (name, text or numbers) of what an image states."""
    rational = openimageio().RATIONAL
    for said in spec.extra_attribs:
        if said.type.arraylen > MOST_NUMBERS:
            continue
        value = said.value
        if isinstance(value, str):
            yield said.name, value
        elif isinstance(value, int | float):
            yield said.name, (float(value),)
        elif isinstance(value, tuple) and all(
            isinstance(v, int | float) for v in value
        ):
            if said.type.vecsemantics == rational:
                yield said.name, f"{value[0]}/{value[1]}"
            else:
                yield said.name, tuple(map(float, value))


def state(spec: Any, space: str) -> None:
    """Make an image be of a colour space, whatever its file says."""
    spec.attribute("oiio:ColorSpace", space)
    for name in OTHER_STATEMENTS:
        spec.erase_attribute(name)
