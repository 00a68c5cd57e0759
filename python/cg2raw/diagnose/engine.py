# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""diagnose(): frames, nuisances, search, verdict."""

import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cg2raw.diagnose import words
from cg2raw.diagnose.captures import CaptureSet
from cg2raw.diagnose.diagnosis import (
    Alternative,
    Diagnosis,
    Finding,
    Gap,
    ResidualTest,
    Rung,
)
from cg2raw.diagnose.found_profile import found_profile
from cg2raw.diagnose.frames import Frame, frame_of, repeat_of, source_of
from cg2raw.diagnose.gap import gap_of, systematic
from cg2raw.diagnose.intervals import estimates, smallest_visible
from cg2raw.diagnose.likelihood import Workers
from cg2raw.diagnose.noise_estimate import noise_models
from cg2raw.diagnose.nuisances import hide_highlights, nuisance_of
from cg2raw.diagnose.pictures import curves_of, histogram
from cg2raw.diagnose.prediction import Model
from cg2raw.diagnose.registration import Registration
from cg2raw.diagnose.residual_tests import residual_tests
from cg2raw.diagnose.search import Search, Step
from cg2raw.diagnose.tiling import tiling
from cg2raw.diagnose.vocabulary import Candidate, candidates, confusable
from cg2raw.diagnose.whole_frames import look_at

Progress = Callable[[str, float], None]

PIXELS = 65536  # of one frame that are worked on; a small frame is taken whole
STRUCTURE = 1e-3  # chance of one false alarm among all residual tests
LEAST_NATS = 2e-4  # per pixel; what is smaller is a trace, and no structure
SHARE_LEFT = 1e-3  # of what was closed, likewise
SHAPE = 0.01  # of the gain of an effect that looks alike
CERTAIN_E = 690.0  # log of the largest e-value that is written


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
) -> Diagnosis:
    """Find what a sensor's model lacks to explain its captures.

    alpha : chance of a false first name, 0 < alpha < 1.
    most : effects that are added at most.
    without, only : names to leave out of, or to restrict the vocabulary to.
    progress : called with what is being done and the share that is done.
    threads : number of frames worked on at a time; the result does not depend on it.
    pixels : of every frame that are worked on; tiles of a larger one are chosen.
    details : False for neither pictures nor curves.

    Ctrl-C ends the search, not the report. Raises ValueError for captures that cannot
    be diagnosed. Source: split likelihood-ratio test, see `search`."""
    if not 0 < alpha < 1:
        raise ValueError(f"alpha {alpha} must lie between 0 and 1")
    started = time.monotonic()
    say = progress or (lambda text, share: None)
    workers = Workers(threads)
    frames = _frames(capture_set, pixels, say)
    groups = _groups(frames)
    registration = _registration(capture_set, frames, say)
    base = _base_model(capture_set, frames, groups["fit"], workers)
    vocabulary = _vocabulary(capture_set, frames, without, only)
    steps = [0]

    def report(text: str) -> None:
        steps[0] += 1
        say(text, 0.3 + 0.6 * (1 - np.exp(-steps[0] / 120)))

    search = Search(
        groups["fit"],
        groups["select"],
        vocabulary,
        workers,
        alpha,
        most,
        report,
        registration.again if registration else None,
    )
    model = search.run(base)
    say("writing down what was found", 0.92)
    found = _concluded(
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
    found.interrupted = search.interrupted
    found.seconds = time.monotonic() - started
    say("done", 1.0)
    return found


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
    model = Model(capture_set.sensor)
    if capture_set.nuisances:
        for frame in frames:
            hide_highlights(frame, model)
    return replace(model, nuisance=nuisance_of(capture_set, fit_frames, workers))


def _vocabulary(
    capture_set: CaptureSet,
    frames: Sequence[Frame],
    without: Collection[str],
    only: Collection[str],
) -> list[Candidate]:
    """Return what may be named: not what floats as a nuisance, nor noise that was
    estimated from the captures themselves."""
    known = candidates(capture_set.sensor.cfa, without)
    if only:
        candidates(capture_set.sensor.cfa, only)  # refuses unknown names
        known = [candidate for candidate in known if candidate.name in only]
    floating = set(capture_set.nuisances)
    timed = all(frame.capture.exposure_time for frame in frames)
    return [
        candidate
        for candidate in known
        if candidate.name not in floating
        and (timed or candidate.name not in ("dark_current", "hot_pixels"))
    ]


def _structure(
    tests: Sequence[ResidualTest], gained: float
) -> tuple[list[ResidualTest], list[ResidualTest]]:
    """Return (tests that say that something is left, traces too small to matter)."""
    least = max(LEAST_NATS, SHARE_LEFT * gained)
    alarms = [test for test in tests if test.p_value < STRUCTURE / len(tests)]
    return (
        [test for test in alarms if test.nats_per_pixel > least],
        [test for test in alarms if test.nats_per_pixel <= least],
    )


def _findings(
    model: Model, steps: Sequence[Step], values: Any, gap: Gap, provisional: bool
) -> list[Finding]:
    findings = []
    for term in model.terms:
        step = next(s for s in reversed(steps) if s.name == term.name)
        gain = step.gain - step.null_gain
        others = [
            Alternative(name, height)
            for name, height in step.ranking
            if name != term.name
        ]
        findings.append(
            Finding(
                name=term.name,
                parameters=values[term.name],
                gain_nats=step.gain,
                e_value=float(np.exp(min(gain, CERTAIN_E))),
                alternatives=others,
                ambiguous_with=list(step.ambiguous),
                where=words.where(term.name),
                sentence=words.sentence(term.name, values[term.name], gap),
                provisional=provisional,
            )
        )
    return findings


def _without_shapes(
    findings: Sequence[Finding], vocabulary: Sequence[Candidate]
) -> tuple[list[Finding], list[str]]:
    """Return (findings, notes on those that are no findings): an effect's model has a
    shape, and what the true one has beside it is taken up by an effect that looks
    alike. It stays in the model, and is not called an effect of its own."""
    known = {candidate.name: candidate for candidate in vocabulary}
    kept, notes = [], []
    for finding in findings:
        larger = [
            other.name
            for other in findings
            if confusable(known[finding.name], known[other.name])
            and finding.gain_nats < SHAPE * other.gain_nats
        ]
        if not larger:
            kept.append(finding)
            continue
        share = finding.gain_nats / sum(f.gain_nats for f in findings)
        notes.append(
            f"{words.title(finding.name).capitalize()} takes up what the model of "
            f"{words.title(larger[0])} does not describe ({share:.1%} of the gain): it "
            "is in the profile, and is no finding of its own."
        )
    return kept, notes


def _verdict(findings: Sequence[Finding], left: Sequence[ResidualTest]) -> str:
    if not findings:
        return "unknown structure" if left else "no gap"
    if left:
        return "identified, rest unexplained"
    ambiguous = any(finding.ambiguous_with for finding in findings)
    return "ambiguous" if ambiguous else "identified"


def _concluded(
    base: Model,
    model: Model,
    search: Search,
    groups: dict[str, list[Frame]],
    workers: Workers,
    alpha: float,
    vocabulary: Sequence[Candidate],
    capture_set: CaptureSet,
    registration: Registration | None,
    details: bool,
) -> Diagnosis:
    report = groups["report"]
    look = look_at(capture_set, report, base, model, registration, workers, details)
    gap = gap_of(
        look.before,
        look.after,
        (systematic(base, base, report), systematic(model, base, report)),
        sorted({frame.capture.name for frame in report}),
    )
    before = residual_tests(base, groups["select"], workers)
    after = residual_tests(model, report, workers)
    left, traces = _structure(after, gap.before - gap.after)
    values = estimates(model, groups["fit"], workers)
    every = _findings(model, search.steps, values, gap, bool(left))
    findings, shapes = _without_shapes(every, vocabulary)
    shown = report if details else []
    return Diagnosis(
        verdict=_verdict(findings, left),
        sensor_id=capture_set.sensor.id,
        effects=findings,
        gap=gap,
        tests_before=before,
        tests_after=after,
        unexplained=left,
        ladder=[_rung(step) for step in search.steps],
        power=smallest_visible(model, vocabulary, groups["select"], workers, alpha),
        next_captures=[
            text
            for finding in findings
            for text in words.deciding_captures(finding.name, finding.ambiguous_with)
        ],
        notes=[*_notes(capture_set, report, traces), *shapes],
        groups={n: [f.capture.name for f in fs] for n, fs in groups.items()},
        pictures=list(look.pictures),
        curves=curves_of(model, values, shown) if details else [],
        histogram_before=histogram(base, report, workers),
        histogram_after=histogram(model, report, workers),
        profile_json=found_profile(model, groups["fit"], findings, values),
    )


def _rung(step: Step) -> Rung:
    ranking = [Alternative(name, gain) for name, gain in step.ranking]
    return Rung(step.action, step.name, step.gain, ranking)


def _notes(
    capture_set: CaptureSet, frames: Sequence[Frame], traces: Sequence[ResidualTest]
) -> list[str]:
    notes = list(getattr(capture_set, "notes", ()))
    if capture_set.nuisances:
        words_ = ", ".join(sorted(capture_set.nuisances))
        notes.append(f"Floated without being called an effect: {words_}.")
    if any(not frame.noise.measured for frame in frames):
        notes.append(
            "The profile has no noise at these ISOs: it was estimated from the "
            "captures, so that its level proves nothing."
        )
    for test in traces:
        notes.append(
            f"A trace, too small to matter: {test.name} "
            f"({test.nats_per_pixel:.2g} nats/pixel)."
        )
    return notes
