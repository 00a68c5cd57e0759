# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Studies of what is learnt, draw by draw: an interrupted run goes on where it was.

A draw has a training set of each source, first weights and order of its own. Each set
of test frames, and each set of renders, has an entry of its own in results.json."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import monotonic
from typing import Any

from studies.cameras import Camera
from studies.fingerprint import MadeBy, limited, made_by, torch_version
from studies.learners.translation_store import translator_for
from studies.places import files_hash
from studies.results import (
    Results,
    add,
    appended,
    draws_of,
    entry_of,
    write_results,
)
from studies.sources.exposures import by_exposure
from studies.sources.frames import Frames, TestSets, captured
from studies.sources.mosaics import by_file
from studies.sources.renders import Renders
from studies.sources.sets import Draw, Material, Sources, few, material, sources
from studies.tasks import content, denoising, illuminant, isp, isp_unet, mosaics
from studies.world.shots import World, lit_by

TESTS = "world"  # test frames of the world
RENDERS = "night renders"
JUDGE = "Mitsuba's frames"


@dataclass(frozen=True)
class Learned:
    """A study that trains on each source and draw."""

    frames: str  # the protocol's table that says how many
    kind: str  # of its scenes
    test_frames: Callable[[World, Camera, str], Frames]
    draw: Callable[[Draw, Sources, TestSets], Mapping[str, Any]]  # {tests: values}
    # What makes its sources of a seed, given a translator if it is translated.
    sources: Callable[..., Sources] = by_exposure
    translated: bool = True  # if PyTorch is there
    more_tests: Callable[[World, Camera, str], TestSets] | None = None
    leds: bool = True  # whether lights of training may be LEDs
    files: Callable[[], list[Path]] = list  # of camera data, beside those of cameras

    def tables(self, study: str) -> list[str]:
        """Return the tables of the protocol that the study of that name is given."""
        found = {study, self.frames, *(["translation"] if self.translated else [])}
        return sorted(found)

    def described(self) -> dict[str, Any]:
        """Return what tells it from other studies of the same code."""
        functions = {
            "draw": self.draw.__name__,
            "sources": self.sources.__name__,
            "tests": self.test_frames.__name__,
        }
        return {**functions, "kind": self.kind, "leds": self.leds}


def by_day(
    draw: Callable[[Draw, Sources, TestSets], Mapping[str, Any]],
    made_by: Callable[..., Sources],
    translated: bool = False,
) -> Learned:
    """Return a study of illuminants."""
    frames = illuminant.test_frames
    return Learned("illuminant", "day", frames, draw, made_by, translated)


LEARNED = {
    "illuminant": replace(
        by_day(illuminant.illuminant_draw, sources, translated=True),
        more_tests=illuminant.tests_by_light,
    ),
    "light_draws": replace(
        by_day(illuminant.light_draws_draw, few), more_tests=illuminant.tests_by_light
    ),
    "held_out_leds": replace(
        by_day(illuminant.held_out_draw, few),
        more_tests=illuminant.tests_by_light,
        leds=False,
    ),
    "denoising": Learned(
        "denoising", "night", denoising.test_frames, denoising.denoising_draw
    ),
    "files": Learned(
        "denoising",
        "night",
        denoising.test_frames,
        mosaics.files_draw,
        by_file,
        translated=False,
    ),
    "photographs": Learned(
        "denoising",
        "night",
        mosaics.test_photographs,
        mosaics.photographs_draw,
        translated=False,
        files=mosaics.files,
    ),
    "denoising_unet": Learned(
        "denoising",
        "night",
        denoising.test_frames,
        denoising.unet_draw,
        translated=False,
    ),
    "isp": Learned("isp", "night", isp.test_frames, isp.isp_draw),
    "isp_unet": Learned(
        "isp", "night", isp.test_frames, isp_unet.isp_unet_draw, translated=False
    ),
    "content": Learned("isp", "night", isp.test_frames, content.content_draw),
}


@dataclass(frozen=True)
class Run:
    """What a command line asks of each study, and where the results go."""

    world: World
    mode: str  # quick or full
    results: Results
    folder: Path
    say: Callable[[str], None]
    renders: Renders | None = None  # of a folder, in place of the world's
    judge: Callable[[str], Frames] | None = None  # frames of a camera by another hand
    # Hashes of the folders that entries are made of, by RENDERS and JUDGE.
    folders: Mapping[str, str] = field(default_factory=dict)


def entry_name(study: str, tests: str, run: Run) -> str:
    """Return what results.json calls a study's entry: what it was made of follows."""
    parts = [study]
    parts += [RENDERS] if run.renders is not None else []
    parts += [tests] if tests != TESTS else []
    return ", ".join(parts)


def made_by_of(run: Run, study: str, name: str) -> MadeBy:
    """Return what an entry of a study depends on. name : of the entry."""
    learned = LEARNED[study]
    given_by = (learned.draw, learned.sources, learned.test_frames)
    modules = {function.__module__ for function in given_by}
    modules |= {translator_for.__module__} if learned.translated else set()
    found = made_by(
        run.world,
        run.mode,
        learned.tables(study),
        modules,
        (sources_of, material_of),
    )
    folders = {of: h for of, h in run.folders.items() if of in name.split(", ")}
    found |= {"study": learned.described(), "folders": folders}
    if files := learned.files():
        found["files"] = files_hash(files)
    return found


def go_on(run: Run, study: str, camera: Camera) -> None:
    """Run those draws of a study that its entries lack; each is written when done."""
    learned = LEARNED[study]
    run = replace(run, world=limited(run.world, learned.tables(study)))
    tests = {TESTS: learned.test_frames(run.world, camera, run.mode)}
    if learned.more_tests is not None:
        tests |= learned.more_tests(run.world, camera, run.mode)
    if run.judge is not None and learned.kind == "night":
        tests[JUDGE] = captured(run.judge(camera.id))
    names = {of: entry_name(study, of, run) for of in tests}
    made = {name: made_by_of(run, study, name) for name in names.values()}
    draws = getattr(run.world.protocol, study).draws[run.mode]
    first = min(
        draws_of(entry_of(run.results, camera, name)) for name in names.values()
    )
    start = monotonic()
    for seed in range(first, draws):
        entries = {
            of: entry_of(run.results, camera, name) for of, name in names.items()
        }
        missing = {of: tests[of] for of, e in entries.items() if draws_of(e) == seed}
        draw = Draw(run.world, camera, run.mode, seed, run.folder)
        found = learned.draw(draw, sources_of(run, learned, draw), missing)
        for of, values in found.items():
            name = names[of]
            add(run.results, camera, name, appended(entries[of], values), made[name])
        write_results(run.folder, run.results)
        left = (monotonic() - start) / (seed + 1 - first) * (draws - seed - 1)
        run.say(f"{study}, {camera.id}: draw {seed + 1} of {draws}, {left:.0f} s left")


def sources_of(run: Run, learned: Learned, draw: Draw) -> Sources:
    """Return the sources of a draw; those of translation only with PyTorch, of the
    cameras that the protocol names."""
    found = material_of(run, learned, draw.camera, draw.seed)
    if not learned.translated or torch_version() is None:
        return learned.sources(found, draw.camera, draw.seed)
    rules = run.world.protocol.translation
    if draw.camera.id not in rules.trained_for:
        return learned.sources(found, draw.camera, draw.seed)
    seed = draw.seed % rules.translators[run.mode]
    seen = found
    if seed != draw.seed:
        seen = material_of(run, learned, draw.camera, seed)
    scenes = learned.kind if run.renders is None else f"{learned.kind}-renders"
    translator = translator_for(
        seen, draw.camera.id, scenes, seed, run.mode, run.folder, say=run.say
    )
    return learned.sources(found, draw.camera, draw.seed, translator)


def material_of(run: Run, learned: Learned, camera: Camera, seed: int) -> Material:
    """Return what the sources of a seed are made of."""
    protocol = run.world.protocol
    frames = getattr(protocol, learned.frames).frames[run.mode]
    return material(
        run.world if learned.leds else lit_by(run.world, leds=False),
        camera,
        learned.kind,
        protocol.seeds,
        frames,
        seed,
        rendered_images=run.renders,
    )
