# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""diagnose(): darks and flats, then scenes and charts, then what both say."""

import os
import time
from collections.abc import Callable, Collection
from dataclasses import replace

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
    say = progress or (lambda text, share: None)
    deadline = None if time_limit is None else started + time_limit
    names = _names(capture_set, without, only)

    def said(text: str, share: float) -> None:
        if deadline is not None and time.monotonic() > deadline:
            raise TimeIsUp
        say(text, share if is_all else OF_DARKS * share)

    def said_of_images(text: str, share: float) -> None:
        say(text, OF_DARKS + (1 - OF_DARKS) * share if constant else share)

    constant = [c for c in capture_set.captures if c.is_uniform]
    if statistics and not constant:
        raise ValueError(f"{statistics}: statistics are of darks and flats: none here")
    is_all = len(constant) == len(capture_set.captures)
    lit = of_images() | ({FLICKER} if is_shown(capture_set.captures) else set())
    doubted = capture_set.nuisances  # light that is not known may have ramps and steps
    offsets = {FILTER} if doubted else of_means() | {GLOW}
    asked = names & (lit | {*LEVELS} | offsets)
    found, images = None, capture_set
    notes: list[str] = []
    has_both = False
    shown: frozenset[str] = frozenset()
    if constant:
        try:
            with raised():
                own = names if is_all else names - lit
                seen = darks_and_flats(capture_set, alpha, own, said, statistics)
                free = frozenset() if is_all else lit
                shown = seen.shown
                found = diagnosis_of(seen, own, most == 0, free, details)
        except (KeyboardInterrupt, TimeIsUp) as ended:
            interrupted = isinstance(ended, KeyboardInterrupt)
            found = unfinished(capture_set, interrupted=interrupted)
        except ValueError as error:
            rest = [c for c in capture_set.captures if c.kind != "dark"]
            is_of_darks = 0 < len(rest) < len(capture_set.captures)
            if isinstance(error, WithinCode) and is_of_darks and not statistics:
                found = diagnose(
                    replace(capture_set, captures=rest),
                    alpha=alpha,
                    most=most,
                    without=without,
                    only=only,
                    progress=said_of_images,
                    threads=threads,
                    pixels=pixels,
                    details=details,
                    time_limit=deadline and max(deadline - time.monotonic(), 0.0),
                )
                notes.append(f"Darks are left out: {error}.")
                return replace(found, notes=[*notes, *found.notes])
            if is_all or statistics:
                raise
            notes.append(f"Darks and flats decide nothing: {error}.")
        if found and (is_all or found.verdict == "incomplete"):
            say("done", 1.0)
            return _finished(found, names - shown, capture_set, started)
        if found:
            used = [*seen.frames.captures, *seen.frames.spoiled]
            images = with_images_alone(capture_set, found, seen.frames.masked, used)
            kinds = {one.kind for one in seen.statistics.groups}
            has_both = {"dark", "flat"} <= kinds
            decided = shown if "dark" in kinds else shown - of_means()
            asked -= (decided | {one.name for one in found.effects}) - lit
    workers = Workers(threads, deadline)
    second = _of_images(
        images,
        asked,
        alpha,
        most,
        said_of_images,
        workers,
        pixels,
        details,
        found is not None or most == 0,
    )
    say("done", 1.0)
    whole = second if found is None else together(found, second, not has_both)
    whole = replace(whole, notes=[*notes, *whole.notes])
    return _finished(whole, names - shown - lit | asked, capture_set, started)


def _finished(
    found: Diagnosis, names: Collection[str], capture_set: CaptureSet, started: float
) -> Diagnosis:
    """Return a diagnosis with its seconds, and with a limit, of None, of each effect
    that might have been named and that no frame shows."""
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
        seconds=time.monotonic() - started,
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
    alpha: float,
    most: int,
    say: Progress,
    workers: Workers,
    pixels: int | None,
    details: bool,
    is_noise_known: bool,
) -> Diagnosis:
    """Return what scenes, charts and flats of known light show.

    names : which may be named. is_noise_known : by darks and flats."""
    frames = read_frames(capture_set, noise_models(capture_set), pixels, say)
    measured = all(f.noise.measured for f in frames if f.samples is None)
    found = decide(
        capture_set,
        frames,
        names,
        alpha=alpha,
        most=most,
        fits_noise=not (is_noise_known and measured),
        workers=workers,
        say=say,
    )
    say("writing down what was found", 0.92)
    return diagnosis_of_images(found, details)
