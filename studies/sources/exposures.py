# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sources by night: methods that make RAW of renders, at the exposures that users of
cg2raw may give them.

An exposure is a gain on scene-linear values before anything clips, of the words of
cg2raw.Run; the core decides it, and all methods get the same exposed renders. Some are
of the training captures, as `cg2raw match` finds them."""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from cg2raw import Run, Sensor
from cg2raw.match import Comparison, Frame, compare, look
from cg2raw.match.renders import Model, simulated
from studies.cameras import Camera
from studies.sources.frames import Frames, Image, captured, cast, words_of
from studies.sources.ours import drawn, ours
from studies.sources.sets import Material, Sources
from studies.sources.translation import Translator, translation
from studies.sources.upi import drawn_global_gains, upi
from studies.world.exposure import exposed

EXPOSURES = {"own": "0", "random": "random:0:2", "auto": "auto"}  # as cg2raw has them
MATCH = "match"
REC709 = np.array([0.2126, 0.7152, 0.0722], np.float32)  # luminance
LIGHT = "D65"  # of a run whose exposure alone is asked for


def by_exposure(
    found: Material, camera: Camera, seed: int, translator: Translator | None = None
) -> Sources:
    """Return what makes the training frames of a seed: captures; METHOD, EXPOSURE.

    "own" is the renders' own brightness, "match" gives them the levels of the captures
    by rank, "captures' median" brightens all by as many stops as they are darker in the
    median. Ours draws lights near the captures' neutrals. UPI's global gain is 1, but
    for the pair in which both have it. Without a matrix, renders are multiplied by
    ours' neutrals. If renders are not the world's, those of the world, whose scenes are
    like the captures', are one source more."""
    told, count = camera.told(found.captures.neutrals), len(found.as_rendered)
    lights = drawn(count, seed, "measured")

    @cache
    def images(exposure: str) -> list[Image]:
        return exposed_by(told, found.as_rendered, exposure, seed)

    @cache
    def matched() -> list[Image]:
        return exposed_by_match(told, found.captures, found.as_rendered, seed)

    by: Mapping[str, Callable[[], list[Image]]] = {
        **{name: partial(images, word) for name, word in EXPOSURES.items()},
        MATCH: matched,
    }

    def ours_of(
        renders: Callable[[], list[Image]],
        convention: str = "dng",
        gains: Sequence[float] = (),
    ) -> Frames:
        return ours(renders(), told, convention, lights=lights, gains=gains)

    def upi_of(
        renders: Callable[[], list[Image]], global_gains: bool = False
    ) -> Frames:
        return upi(renders(), told, global_gains=global_gains, seed=seed)

    def as_bright() -> list[Image]:
        return images(str(darker(told, found.captures, found.as_rendered)))

    def of_world() -> list[Image]:
        return exposed_by_match(told, found.captures, found.of_world, seed)

    def with_gains() -> Frames:
        return ours_of(matched, gains=drawn_global_gains(count, told, seed))

    def translated() -> Frames:
        assert translator is not None
        return translation(found.renders, translator, told, lights=our_lights())

    def our_lights() -> list[str]:
        return words_of(np.array([told.illuminant(word).neutral for word in lights]))

    def without_matrix() -> Frames:
        neutrals = np.array([told.illuminant(word).neutral for word in lights])
        return cast(matched(), neutrals)

    more: dict[str, Callable[[], Frames]] = {}
    if found.of_world is not found.as_rendered:
        more["ours, match, world's scenes"] = partial(ours_of, of_world)
    if translator is not None:
        more["translation, our lights"] = translated
    return {
        "real": lambda: captured(found.captures),
        "real, other scenes": lambda: captured(found.other_captures),
        **{f"ours, {name}": partial(ours_of, made) for name, made in by.items()},
        "ours, captures' median": partial(ours_of, as_bright),
        "ours, match, paper": partial(ours_of, matched, convention="paper"),
        "ours, match, global gains": with_gains,
        **{f"upi, {name}": partial(upi_of, made) for name, made in by.items()},
        "upi, match, global gains": partial(upi_of, matched, global_gains=True),
        "no matrix, match": without_matrix,
        **more,
    }


def exposed_by_match(
    sensor: Sensor, captures: Frames, images: Sequence[Image], seed: int
) -> list[Image]:
    """Return images (H, W, 3) at the levels of captures, by rank."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "match.json"
        path.write_text(json.dumps(matching(sensor, captures, images).fields()))
        return exposed_by(sensor, images, f"match:{path}", seed)


def exposed_by(
    sensor: Sensor, images: Sequence[Image], exposure: str, seed: int
) -> list[Image]:
    """Return images (H, W, 3) as cg2raw exposes them, frame by frame of one seed."""
    made = []
    for frame, image in enumerate(images):
        asked = Run(illuminant=LIGHT, exposure=exposure, seed=seed, frame=frame)
        run = sensor.metered(image, asked)
        found = sensor.simulation(image.shape[:2], **vars(run)).exposure
        made.append(np.asarray(image * np.float32(2.0 ** found["stops"]), np.float32))
    return made


def matching(sensor: Sensor, captures: Frames, images: Sequence[Image]) -> Comparison:
    """Return the Comparison of captures as a camera exposes them, and of images
    (H, W, 3) under lights that are drawn as those of source ours."""
    words = words_of(captures.neutrals)
    seen = [
        developed(sensor, exposed(image), word)
        for image, word in zip(captures.images, words, strict=True)
    ]
    model = Model(sensor, drawn(len(images), 0))
    made = [simulated("", image, frame, model) for frame, image in enumerate(images)]
    return compare(sensor.id, seen, made)


def darker(sensor: Sensor, captures: Frames, images: Sequence[Image]) -> float:
    """Return how many stops images (H, W, 3) are darker than captures as a camera
    exposes them: their median luminances, in the median."""
    scenes = [
        sensor.to_scene(exposed(image), illuminant=word)
        for image, word in zip(
            captures.images, words_of(captures.neutrals), strict=True
        )
    ]
    bright, dark = (
        np.median([np.median(image @ REC709) for image in found])
        for found in (scenes, images)
    )
    return float(np.log2(bright / dark))


def developed(sensor: Sensor, image: Image, word: str) -> Frame:
    """Return the match's Frame of camera RGB (H, W, 3), white 1, under a light."""
    plane = sensor.raw_from_signal(sensor.mosaic(image))
    return look("", plane, sensor, sensor.illuminant(word))
