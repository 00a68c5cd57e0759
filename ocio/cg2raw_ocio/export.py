# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One sensor under one illuminant as a file of its own, and how exact that file is.

A CTF holds the chain itself. A CLF has no operator that could multiply two channels, so
it holds matrices and clips without protected highlights, or the table of convention
spectral over the roots themselves. A .cube is a preview."""

import functools
import os
import uuid
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import PyOpenColorIO as ocio
from numpy.typing import NDArray

from cg2raw._core import CameraTransform, SensorProfile
from cg2raw.arrays import FloatImage
from cg2raw.interrupts import scratch_folder

from . import chain, color_effects, cube, measure, names, spectral_chain
from .spaces import Exposure, camera_chain, camera_transform, group, seen_by

FORMATS = {
    ".ctf": "Color Transform Format",
    ".clf": "Academy/ASC Common LUT Format",
}
ENDS = ("InputDescriptor", "OutputDescriptor")
# What a chain that was written and read may differ from itself, DN of 16 bits.
SAME_DN = 0.02


def ctf(
    profile: SensorProfile, illuminant: str, exposure: Exposure
) -> tuple[str, list[str]]:
    """Return (text, findings) of a CTF: scene-linear Rec.709 -> camera RGB, exact but
    for the table of convention spectral."""
    text, ops = raw_text(profile, illuminant, exposure)
    pixels = measure.random_pixels()
    error = measure.error(
        read_back(text, ".ctf", ops, pixels),
        measure.exact_camera(profile, illuminant, exposure, pixels),
    )
    return text, [f"error     {error} (of 65535)"]


def raw_text(
    profile: SensorProfile, illuminant: str, exposure: Exposure
) -> tuple[str, list[chain.Op]]:
    """Return (text, transforms) of that CTF."""
    transform = camera_transform(profile, illuminant, exposure)
    ops = camera_chain(transform, color_effects.matrix(profile, illuminant))
    seen = seen_by(profile, illuminant, exposure)
    return chain_text(ops, ".ctf", (profile.id, illuminant), seen), ops


def clf(
    profile: SensorProfile, illuminant: str, exposure: Exposure
) -> tuple[str, list[str]]:
    """Return (text, findings) of a CLF: the same without protected highlights."""
    transform = camera_transform(profile, illuminant, exposure)
    ops = plain_chain(transform, color_effects.matrix(profile, illuminant))
    seen = seen_by(profile, illuminant, exposure)
    if transform.keep_highlights:
        seen += " Highlights are not protected: they take the colour of the light."
    text = chain_text(ops, ".clf", (profile.id, illuminant), seen)
    pixels = measure.random_pixels()
    found = read_back(text, ".clf", ops, pixels)
    exact = measure.exact_camera(profile, illuminant, exposure, pixels)
    below = measure.below_highlights(transform, pixels)
    findings = [f"error     {measure.error(found, exact)} (of 65535)"]
    if exposure.has_table:
        findings.append(
            "          a CLF takes negative components for 0, and what is above "
            f"{spectral_chain.CLF_LIMIT**2:g} for that; a CTF (--ctf) does not"
        )
    if transform.keep_highlights:
        inner = measure.error(found[below], exact[below])
        findings += [
            f"          {inner} where highlights do not begin: "
            f"{below.mean():.1%} of [0, 1]^3",
            "          a CLF cannot protect highlights; a CTF (--ctf) does",
        ]
    return text, findings


def preview(
    profile: SensorProfile,
    illuminant: str,
    exposure: Exposure,
    size: int,
    encoding: str,
) -> tuple[str, list[str]]:
    """Return (text, findings) of a .cube of size^3 whose input is linear or srgb."""
    name, *_ = names.raw_space(profile.id, illuminant)
    title = f"{encoding} Rec.709 to {name}"
    text = cube.cube_text(profile, illuminant, exposure, size, encoding, title)
    findings = []
    for what, pixels in (
        ("random pixels", measure.random_pixels()),
        ("a neutral ramp", measure.neutral_ramp()),
    ):
        encoded = cube.encoded_from(pixels, encoding)
        applied = functools.partial(measure.applied, pixels=encoded)
        found = with_file(text, ".cube", applied)
        exact = measure.exact_camera(profile, illuminant, exposure, pixels)
        error = measure.error(found, exact)
        findings.append(f"error     {error} (of 65535) of {what}")
    return text, findings


def plain_chain(
    transform: CameraTransform, effects: chain.Array | None = None
) -> list[chain.Op]:
    """Return matrices and clips alone: a chain without protected highlights; in
    convention spectral a table over roots."""
    if transform.uplift is not None:
        return spectral_chain.of_roots(transform, effects)
    ops = chain.legal() + chain.clipped_product(transform.first)
    if transform.two_steps:
        ops += chain.clipped_product(transform.second)
    ops.append(chain.matrix(np.diag(transform.gains)))
    ops += [chain.clip()] if transform.clip_result else []
    return ops + ([] if effects is None else [chain.matrix(effects)])


def chain_text(
    transforms: Sequence[chain.Op],
    ending: str,
    space: tuple[str, str],
    description: str,
    to_scene: bool = False,
) -> str:
    """Return the text of a .ctf or .clf file of a list of transforms.

    space : (sensor, illuminant), what the RAW is of.
    Its id follows from the contents, so that a chain is the same CTF with every
    OpenColorIO; the schema that heads a CLF is that of the version."""
    whole = group(transforms)
    about = whole.getFormatMetadata()
    name, *_ = names.raw_space(*space)
    ends = (names.SCENE_LINEAR, name)
    about.setName(name)
    about.addChildElement("Description", description)
    for end, text in zip(ENDS, reversed(ends) if to_scene else ends, strict=True):
        about.addChildElement(end, text)
    config = ocio.Config.CreateRaw()
    about.setID("urn:uuid:")
    text = whole.write(FORMATS[ending], config)
    about.setID(uuid.uuid5(uuid.NAMESPACE_OID, text).urn)
    return narrow(str(whole.write(FORMATS[ending], config)))


def narrow(text: str) -> str:
    """Return a file's text with the rows of its 3D table, if it has one, as short as
    can be: OpenColorIO pads "0 0 0" to 36 bytes."""
    start, end = text.find("<LUT3D"), text.find("</LUT3D>")
    if start < 0:
        return text
    rows = (" ".join(row.split()) for row in text[start:end].splitlines())
    return text[:start] + "\n".join(rows) + text[end:]


def read_back(
    text: str, ending: str, transforms: Sequence[chain.Op], pixels: NDArray[Any]
) -> FloatImage:
    """Return (n, 3) pixels through the file's text. Raises ValueError if it is not the
    chain that was written."""
    found = with_file(text, ending, lambda file: measure.applied(file, pixels))
    error = measure.error(found, measure.applied(group(transforms), pixels))
    if not error.max_dn <= SAME_DN:
        raise ValueError(
            f"OpenColorIO {ocio.__version__} reads the {ending} that it wrote with an "
            f"error of {error}; it must be below {SAME_DN} DN"
        )
    return found


def with_file(
    text: str, ending: str, use: Callable[[chain.Op], FloatImage]
) -> FloatImage:
    """Return use(FileTransform) of a temporary file that holds @text."""
    with scratch_folder("cg2raw.") as folder:
        path = os.path.join(folder, "chain" + ending)
        with open(path, "w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
        return use(ocio.FileTransform(path, interpolation=ocio.INTERP_LINEAR))
