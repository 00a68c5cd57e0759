# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""diagnose(): frames, nuisances, search, verdict."""

import itertools
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cg2raw.diagnose.assessment.verdict import concluded
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import Diagnosis, Power
from cg2raw.diagnose.effects.catalogue import Candidate, candidates
from cg2raw.diagnose.frames.frame import Frame, frame_of, repeat_of, source_of
from cg2raw.diagnose.frames.tiling import tiling
from cg2raw.diagnose.inference.fisher_scoring import fit
from cg2raw.diagnose.inference.model_selection import Search
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import TimeIsUp, Workers
from cg2raw.diagnose.likelihood.nuisance import hide_highlights, nuisance_of
from cg2raw.diagnose.likelihood.prediction import PATTERNS, Model, Term, predict

Progress = Callable[[str, float], None]

LEAST_ALIKE = 0.5  # correlation of a capture and its render
HIGHEST = 0.9  # of white, for that
FEWEST = 500  # pixels, for that
PIXELS = 65536  # of one frame that are worked on; a small frame is taken whole


def diagnose(
    capture_set: CaptureSet,
    *,
    alpha: float = 0.01,
    most: int = 6,
    without: Collection[str] = (),
    only: Collection[str] = (),
    progress: Progress | None = None,
    threads: int = 2,
    pixels: int = PIXELS,
    details: bool = True,
    time_limit: float | None = None,
) -> Diagnosis:
    """Find what a sensor's model lacks to explain its captures.

    alpha : chance of a false first name, 0 < alpha < 1.
    most : effects that are added at most.
    without, only : names to leave out of, or to restrict the vocabulary to.
    progress : called with what is being done and the share that is done.
    threads : number of frames worked on at a time; the result does not depend on it.
    pixels : of every frame that are worked on; tiles of a larger one are chosen.
    details : False for neither pictures nor curves.
    time_limit : seconds from the start, after which nothing more is looked for; the
        report then says so. None for as long as it takes.

    Ctrl-C ends alignment and search, not the report. Raises ValueError for captures
    that cannot be diagnosed. Source: split likelihood-ratio test, see `search`."""
    if not 0 < alpha < 1:
        raise ValueError(f"alpha {alpha} must lie between 0 and 1")
    started = time.monotonic()
    say = progress or (lambda text, share: None)
    workers = Workers(threads, None if time_limit is None else started + time_limit)
    frames = _frames(capture_set, pixels, say)
    groups = _groups(frames)
    registration, base, ended = _prepared(capture_set, frames, groups, workers, say)
    vocabulary, unseen = _vocabulary(capture_set, groups, without, only)
    search = Search(
        groups["fit"],
        groups["select"],
        vocabulary,
        workers,
        alpha,
        most,
        _counted(say),
        registration.again if registration else None,
        interrupted=ended is KeyboardInterrupt,
        timed_out=ended is TimeIsUp,
    )
    model = base if ended else search.run(base)
    workers.deadline = None  # the report is written in any case
    say("writing down what was found", 0.92)
    found = concluded(
        base,
        model,
        search,
        groups,
        workers,
        alpha,
        vocabulary,
        capture_set,
        registration,
        details,
    )
    found.power += [Power(c.name, c.parameters[0], None, c.units[0]) for c in unseen]
    found.interrupted = search.interrupted
    found.time_limit_reached = search.timed_out
    found.seconds = time.monotonic() - started
    say("done", 1.0)
    return found


def _counted(say: Progress) -> Callable[[str], None]:
    """Return what reports steps of a search, of which nobody knows the number."""
    steps = itertools.count(1)
    return lambda text: say(text, 0.3 + 0.6 * (1 - np.exp(-next(steps) / 120)))


def _prepared(
    capture_set: CaptureSet,
    frames: Sequence[Frame],
    groups: dict[str, list[Frame]],
    workers: Workers,
    say: Progress,
) -> tuple[Registration | None, Model, type[BaseException] | None]:
    """Return (alignment, doubted model, what came in between: Ctrl-C or the time)."""
    try:
        registration = _registration(capture_set, frames, say)
        base = _base_model(capture_set, frames, groups["fit"], workers)
    except (KeyboardInterrupt, TimeIsUp) as ended:
        return None, Model(capture_set.sensor), type(ended)
    return registration, base, None


def _frames(capture_set: CaptureSet, pixels: int, say: Progress) -> list[Frame]:
    noise = noise_models(capture_set)
    repeat = repeat_of(capture_set.sensor.cfa)
    tiles = {
        shape: tiling(shape, pixels, repeat, _wanted(capture_set, shape))
        for shape in {capture.shape for capture in capture_set.captures}
    }
    frames = []
    for number, capture in enumerate(capture_set.captures):
        say(f"reading {capture.name}", 0.25 * number / len(capture_set.captures))
        source = source_of(capture_set, capture)
        frames.append(frame_of(source, tiles[capture.shape], noise[capture.iso]))
    return frames


def _wanted(capture_set: CaptureSet, shape: tuple[int, int]) -> Any:
    """Return where any capture of a shape counts; None if one counts everywhere."""
    captures = [c for c in capture_set.captures if c.shape == shape]
    wanted = np.zeros(shape, bool)
    for capture in captures:
        if capture.mask is None:
            return None
        wanted |= capture.mask()
    return wanted


def _groups(frames: Sequence[Frame]) -> dict[str, list[Frame]]:
    groups: dict[str, list[Frame]] = {"fit": [], "select": [], "report": []}
    for frame in frames:
        groups[frame.capture.group].append(frame)
    for name, members in groups.items():
        if not members:
            raise ValueError(
                f"no frame is in the group {name}: not enough to fit, select and "
                "report on different frames; add frames"
            )
    return groups


def _registration(
    capture_set: CaptureSet, frames: Sequence[Frame], say: Progress
) -> Registration | None:
    """Align renders with captures, if they may be displaced or differently bright."""
    floating = capture_set.nuisances
    if not floating & {"registration", "exposure"}:
        return None
    say("aligning renders with captures", 0.26)
    found = Registration(frames, "registration" in floating, "exposure" in floating)
    found.first(Model(capture_set.sensor))
    return found


def _base_model(
    capture_set: CaptureSet,
    frames: Sequence[Frame],
    fit_frames: Sequence[Frame],
    workers: Workers,
) -> Model:
    """Return the doubted model, with what has to be fitted to use it at all."""
    model = Model(capture_set.sensor)
    if capture_set.nuisances:
        for frame in frames:
            hide_highlights(frame, model)
    _check_correspondence(model, frames)
    nuisance = nuisance_of(capture_set, fit_frames, workers)
    model = replace(model, nuisance=nuisance)
    # A profile says how strong a fixed pattern is; its map is each camera's own.
    fitted = {effect["name"] for effect in capture_set.sensor.effects} & {*PATTERNS}
    if not all(frame.noise.measured for frame in frames):
        fitted |= {"shot_noise", "read_noise"}
    for candidate in candidates(capture_set.sensor.cfa):
        if candidate.name in fitted:
            model = model.with_term(Term(candidate, candidate.null, calibration=True))
    return fit(model, fit_frames, workers) if fitted else model


def _check_correspondence(model: Model, frames: Sequence[Frame]) -> None:
    """Refuse renders of something else than was captured. Raises ValueError."""
    for frame in frames:
        if frame.capture.kind != "scene":
            continue
        p = predict(model, frame)
        used = frame.keep & ~frame.censored & (p.mean < HIGHEST)
        if used.sum() < FEWEST or p.mean[used].std() < np.sqrt(p.variance[used].mean()):
            continue  # too little light or contrast to tell
        alike = float(np.corrcoef(p.mean[used], frame.signal[used])[0, 1])
        if not alike > LEAST_ALIKE:
            raise ValueError(
                f"{frame.capture.name}: the scene does not correspond to the capture: "
                f"they correlate by {alike:.2f}, and {LEAST_ALIKE} is the least: is it "
                "the render of this frame, of the same view and crop, and are both "
                "the same way up?"
            )


def _vocabulary(
    capture_set: CaptureSet,
    groups: dict[str, list[Frame]],
    without: Collection[str],
    only: Collection[str],
) -> tuple[list[Candidate], list[Candidate]]:
    """Return (what may be named, what no frames show), but for what floats as a
    nuisance."""
    known = candidates(capture_set.sensor.cfa, without)
    if only:
        candidates(capture_set.sensor.cfa, only)  # refuses unknown names
        known = [candidate for candidate in known if candidate.name in only]
    known = [c for c in known if c.name not in capture_set.nuisances]
    shown = _shown_by(groups["fit"]) & _shown_by(groups["select"])
    return (
        [candidate for candidate in known if candidate.needs <= shown],
        [candidate for candidate in known if not candidate.needs <= shown],
    )


def _shown_by(frames: Sequence[Frame]) -> set[str]:
    """Return what frames have of what effects need to be seen."""
    kinds = {frame.capture.kind for frame in frames}
    shown = set()
    if kinds - {"dark"}:
        shown.add("light")
    if kinds & {"scene", "chart"}:
        shown.add("image")
    if all(frame.capture.exposure_time for frame in frames):
        shown.add("time")
    return shown
