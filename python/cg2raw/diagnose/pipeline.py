# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""diagnose(): darks and flats, then scenes and charts, then what both say."""

import os
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.blas_threads import one_blas_thread
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.darks_and_flats import WithinCode, darks_and_flats
from cg2raw.diagnose.diagnosis import DetectionLimit, Diagnosis
from cg2raw.diagnose.effects.catalogue import candidates, of_images, of_means
from cg2raw.diagnose.frames.reader import read_frames
from cg2raw.diagnose.scenes.decide import GLOW, decide
from cg2raw.diagnose.scenes.flicker import is_shown
from cg2raw.diagnose.scenes.noise_level import noise_models
from cg2raw.diagnose.scenes.nuisances import UNSEEN
from cg2raw.diagnose.verdict.constant import diagnosis_of, unfinished
from cg2raw.diagnose.verdict.images import diagnosis_of_images
from cg2raw.diagnose.verdict.together import together, with_images_alone
from cg2raw.diagnose.workers import TimeIsUp, Workers
from cg2raw.interrupts import raised
from cg2raw.model.dark_levels import LEVELS
from cg2raw.model.flicker import NAME as FLICKER
from cg2raw.model.lags import FILTER
from cg2raw.sensor import Sensor

Progress = Callable[[str, float], None]
OF_DARKS = 0.3  # of the progress of darks, flats and images


@dataclass(frozen=True, kw_only=True)
class Settings:
    """As of diagnose(). names : which may be named. deadline : of time.monotonic()."""

    alpha: float
    most: int
    names: frozenset[str]
    threads: int
    pixels: int | None
    details: bool
    deadline: float | None
    statistics: str | os.PathLike[str] | None


@one_blas_thread
def diagnose(
    capture_set: CaptureSet,
    *,
    alpha: float = 0.01,
    most: int = 6,
    without: Collection[str] = (),
    only: Collection[str] = (),
    progress: Progress | None = None,
    threads: int = 2,
    pixels: int | None = None,
    details: bool = True,
    time_limit: float | None = None,
    statistics: str | os.PathLike[str] | None = None,
) -> Diagnosis:
    """Find what a sensor's model lacks to explain its captures.

    alpha : chance of a false first name, 0 < alpha < 1.
    most : effects that images name at most, beside those of darks and flats; 0 for none
        at all.
    without, only : names to leave out of, or to restrict the effects to.
    progress : called with what is being done and the share that is done.
    threads : number of frames worked on at a time; the result does not depend on it.
    pixels : of every frame that are worked on; tiles of a larger one are chosen. None
        for 65536, or fewer of more than 64 frames.
    details : False for neither pictures, curves nor charts.
    time_limit : seconds from the start, after which nothing more is looked for; the
        report then says so. None for as long as it takes.
    statistics : an .npz file of those of darks and flats, with their mean images: four
        bytes a pixel, exposure time or level, and split. It is written if it is not
        there; else it stands for the frames, whose files must be as they were.

    Ctrl-C ends what is decided, not the report. Raises ValueError for captures that
    cannot be diagnosed, and for a file that is not of them; OSError. Source: split
    likelihood-ratio test, see `scenes.selection`."""
    if not 0 < alpha < 1:
        raise ValueError(f"alpha {alpha} must lie between 0 and 1")
    started = time.monotonic()
    settings = Settings(
        alpha=alpha,
        most=most,
        names=_names(capture_set, without, only),
        threads=threads,
        pixels=pixels,
        details=details,
        deadline=None if time_limit is None else started + time_limit,
        statistics=statistics,
    )
    say = progress or (lambda text, share: None)
    try:
        found = _diagnosis_of(capture_set, settings, say)
    except WithinCode as error:
        rest = [one for one in capture_set.captures if one.kind != "dark"]
        if statistics or not 0 < len(rest) < len(capture_set.captures):
            raise
        found = _diagnosis_of(
            replace(capture_set, captures=rest),
            settings,
            lambda text, share: say(text, OF_DARKS + (1 - OF_DARKS) * share),
        )
        found = replace(found, notes=[f"Darks are left out: {error}.", *found.notes])
    say("done", 1.0)
    return replace(found, seconds=time.monotonic() - started)


def _diagnosis_of(
    capture_set: CaptureSet, settings: Settings, say: Progress
) -> Diagnosis:
    """Return what all captures say. Raises WithinCode if darks among them say nothing
    for their codes."""
    names, deadline = settings.names, settings.deadline
    uniform = [one.is_uniform for one in capture_set.captures]
    is_all = all(uniform)
    if settings.statistics and not any(uniform):
        raise ValueError(
            f"{settings.statistics}: statistics are of darks and flats: none here"
        )

    def said(text: str, share: float) -> None:
        if deadline is not None and time.monotonic() > deadline:
            raise TimeIsUp
        say(text, share if is_all else OF_DARKS * share)

    def said_of_images(text: str, share: float) -> None:
        say(text, OF_DARKS + (1 - OF_DARKS) * share if any(uniform) else share)

    lit = of_images() | ({FLICKER} if is_shown(capture_set.captures) else set())
    doubted = capture_set.nuisances  # light that is not known may have ramps and steps
    offsets = {FILTER} if doubted else of_means() | {GLOW}
    asked = names & (lit | {*LEVELS} | offsets)
    stated = {entry["name"] for entry in capture_set.sensor.effects or ()}
    doubts = names & {*UNSEEN} - asked - stated
    found, images = None, capture_set
    notes: list[str] = []
    has_both = False
    shown: frozenset[str] = frozenset()
    if any(uniform):
        own, free = (names, frozenset[str]()) if is_all else (names - lit, lit)
        try:
            with raised():
                seen = darks_and_flats(
                    capture_set, settings.alpha, own, said, settings.statistics
                )
                shown = seen.shown
                is_judged = settings.most == 0
                found = diagnosis_of(seen, own, is_judged, free, settings.details)
        except (KeyboardInterrupt, TimeIsUp) as ended:
            interrupted = isinstance(ended, KeyboardInterrupt)
            found = unfinished(capture_set, interrupted=interrupted)
        except ValueError as error:
            has_darks = any(one.kind == "dark" for one in capture_set.captures)
            are_left_out = isinstance(error, WithinCode) and has_darks
            if is_all or settings.statistics or are_left_out:
                raise
            notes.append(f"Darks and flats decide nothing: {error}.")
        if found and (is_all or found.verdict == "incomplete"):
            return _finished(found, names - shown, capture_set)
        if found:
            used = [*seen.frames.captures, *seen.frames.spoiled]
            images = with_images_alone(capture_set, found, seen.frames.masked, used)
            kinds = {one.kind for one in seen.statistics.groups}
            has_both = {"dark", "flat"} <= kinds
            decided = shown if "dark" in kinds else shown - of_means()
            asked -= (decided | {one.name for one in found.effects}) - lit
            doubts -= decided
    is_noise_known = found is not None or settings.most == 0
    second = _of_images(images, asked, doubts, settings, said_of_images, is_noise_known)
    whole = second if found is None else together(found, second, not has_both)
    whole = replace(whole, notes=[*notes, *whole.notes])
    return _finished(whole, names - shown - lit | asked, capture_set)


def _finished(
    found: Diagnosis, names: Collection[str], capture_set: CaptureSet
) -> Diagnosis:
    """Return a diagnosis with its units, and with a limit, of None, of each effect that
    might have been named and that no frame shows."""
    told = {one.name for one in found.effects}
    told |= {one.name for one in found.detection_limits}
    unseen = [
        DetectionLimit(one.name, one.parameters[0], None, one.units[0])
        for one in candidates(capture_set.sensor.cfa)
        if one.name in names and one.name not in told
    ]
    if found.verdict == "incomplete":
        unseen = []
    sensor = capture_set.sensor
    if found.profile_json:
        sensor = Sensor.from_json(found.profile_json, f"{sensor.id} as found")
    white = sensor.signal_range
    isos = {one.iso for one in capture_set.captures}
    rows = [row for row in sensor.noise or () if {row["iso"]} == isos]
    shot = float(np.mean(rows[0]["beta1"])) * white if rows else 0.0
    return replace(
        found,
        detection_limits=[*found.detection_limits, *unseen],
        white_dn=white,
        electrons_per_dn=1 / shot if shot > 0 else None,
    )


def _names(
    capture_set: CaptureSet, without: Collection[str], only: Collection[str]
) -> frozenset[str]:
    """Return the effects that may be named. Raises ValueError for unknown names."""
    known = candidates(capture_set.sensor.cfa, without)
    if only:
        candidates(capture_set.sensor.cfa, only)  # refuses unknown names
    names = {one.name for one in known if not only or one.name in only}
    return frozenset(names - capture_set.nuisances)


def _of_images(
    capture_set: CaptureSet,
    names: Collection[str],
    doubts: Collection[str],
    settings: Settings,
    say: Progress,
    is_noise_known: bool,
) -> Diagnosis:
    """Return what scenes, charts and flats of known light show.

    names : which may be named. doubts : which there may be, unseen. is_noise_known : by
    darks and flats."""
    frames = read_frames(capture_set, noise_models(capture_set), settings.pixels, say)
    measured = all(f.noise.measured for f in frames if f.samples is None)
    found = decide(
        capture_set,
        frames,
        names,
        doubts=doubts,
        alpha=settings.alpha,
        most=settings.most,
        fits_noise=not (is_noise_known and measured),
        workers=Workers(settings.threads, settings.deadline),
        say=say,
    )
    say("writing down what was found", 0.92)
    return diagnosis_of_images(found, settings.details)
