# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""calibrate: from frames to a Calibration.

Flats come first: which of them are of use. Then all frames are fitted together; then
what the fit does not give, of darks, and of flats above them."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from cg2raw.blas_threads import one_blas_thread
from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.darks import read_darks
from cg2raw.calibration.defects import Mask, defects_of
from cg2raw.calibration.fitting import fitted
from cg2raw.calibration.flats import FULL_WELL, above_darks, check_curve, read_flats
from cg2raw.calibration.frames import (
    MOST_SATURATED,
    Group,
    Scanned,
    UniformFrame,
    groups_of,
    in_steps,
    scan,
    screened,
)
from cg2raw.calibration.notes import notes_on
from cg2raw.calibration.parts import check_one_chain
from cg2raw.calibration.seen import Seen, seen_all
from cg2raw.calibration.sites import sites_of
from cg2raw.sensor import Sensor
from cg2raw.statistics.kept import Kept

# At all frames, at most, while there are defects that the statistics have not masked:
# wide ones hide where they end.
LOOKS = 3

Progress = Callable[[str, float], None]


@one_blas_thread
def calibrate(
    sensor: Sensor,
    frames: Sequence[UniformFrame],
    *,
    threads: int = 2,
    progress: Progress | None = None,
) -> Calibration:
    """Return what darks and flats show of a sensor.

    sensor : whose CFA, bits and white level hold; black level and noise are measured.
    frames : UniformFrames of one size and one ISO, two that repeat each other at least.
    threads : 2 reads the next frame during the work on one; the result is the same.
    progress : called with what is done now, and the share done, 0 to 1.

    At most two frames, a map of each group and a few others are held at a time.
    Raises ValueError naming frame, field, value and what is allowed. Source: EMVA
    Standard 1288, release 4.0; all steps are robust against hot pixels and transients.
    """
    tell = progress or (lambda words, share: None)
    kept = Kept()
    frames = [replace(frame, raw=kept.reader(frame.raw)) for frame in frames]
    iso = one_iso(frames)
    scanned = scan_all(sensor, frames, threads, tell)
    step, scanned = in_steps(scanned, sensor.white_level)
    groups, excluded = screened(groups_of(scanned), np.array(sensor.black_level))
    check_groups(groups)
    sites = replace(sites_of(sensor), step=step)
    dark_groups, flat_groups = (
        [group for group in groups if group.kind == kind] for kind in ("dark", "flat")
    )
    levels = np.asarray(sensor.black_level, float)
    if dark_groups:
        levels = dark_groups[0].level
    flat_groups.sort(key=lambda group: float(group.level.mean()))
    listed = [*dark_groups, *flat_groups]

    def look(groups: Sequence[Group], excluded: Mask | None) -> Seen:
        said = lambda x: tell("reading frames", x)  # noqa: E731
        return seen_all(sensor, sites, groups, excluded, threads, said)

    defects = None
    for _ in range(LOOKS):
        seen = look(listed, defects)
        defects = defects_of(seen, levels)
        if (
            defects is None
            or not (defects & ~seen.statistics.masked(defects.shape)).any()
        ):
            break
    flats = read_flats(seen, levels, lambda x: tell("flats", x))
    if flats.clipped_by == FULL_WELL:  # its rim would be masked in all frames
        last = max(flats.used, default=len(dark_groups) - 1)
        seen = look(listed[: last + 1], defects)
    tell("fitting", 0.0)
    fit = fitted(seen, flats.linear(seen, float(levels.mean())), levels, iso)
    check_curve(flats.points, seen, fit.lost == "cut")
    found = Calibration(
        sensor=sensor,
        sites=sites,
        shape=scanned[0].shape,
        iso=iso,
        frames=(
            sum(len(group.frames) for group in dark_groups),
            sum(len(group.frames) for group in flat_groups),
        ),
        fit=fit,
        transients=transients_of(seen),
        excluded=excluded,
        defects=defects,
    )
    tell("darks", 0.0)
    darks = read_darks(seen, fit, found.black)
    light = above_darks(seen, flats, darks, levels, found.black)
    found = replace(found, **vars(darks), **vars(light))
    check_one_chain(found)
    return replace(found, notes=notes_on(found, scanned))


def one_iso(frames: Sequence[UniformFrame]) -> float | None:
    """Return the ISO of all frames, None if none says it. Raises ValueError."""
    if len(frames) < 2:
        raise ValueError(
            f"frames: {len(frames)}; noise shows in the difference of two: give two "
            "that repeat each other at least"
        )
    said = {frame.iso: frame.name for frame in frames if frame.iso is not None}
    if len(said) > 1:
        (a, first), (b, second), *_ = said.items()
        raise ValueError(
            f"{second}: ISO {b:g}, but {first} has ISO {a:g}: calibrate one ISO at a "
            "time; rows of other ISOs stay in the profile"
        )
    return next(iter(said), None)


def scan_all(
    sensor: Sensor, frames: Sequence[UniformFrame], threads: int, tell: Progress
) -> list[Scanned]:
    """Return a first look at each frame. Raises ValueError for another size."""
    sites, found = sites_of(sensor), list[Scanned]()
    with ThreadPoolExecutor(max(1, threads)) as pool:
        for item in pool.map(lambda frame: scan(frame, sites, sensor), frames):
            found.append(item)
            if item.shape != found[0].shape:
                (h, w), (height, width) = item.shape, found[0].shape
                raise ValueError(
                    f"{item.frame.name}: is {w}x{h} pixels, {found[0].frame.name} "
                    f"{width}x{height}: give frames of one size"
                )
            tell("looking at frames", len(found) / len(frames))
    return found


def check_groups(groups: Sequence[Group]) -> None:
    """Raise ValueError unless two frames repeat each other, and some are unsaturated,
    and darks of several exposures all say theirs."""
    darks = [group for group in groups if group.kind == "dark"]
    unknown = [g for g in darks if g.exposure_time is None]
    if unknown and len(darks) > len(unknown):
        raise ValueError(
            f"{unknown[0].frames[0].frame.name}: has no exposure time, other darks "
            "have: give it (--frames frames.csv or --exposure)"
        )
    scanned = [item for group in groups for item in group.frames]
    if all(item.saturated > MOST_SATURATED for item in scanned):
        worst = scanned[0]
        raise ValueError(
            f"{worst.frame.name}: {worst.saturated:.0%} of its pixels are saturated, "
            "and so in all frames: expose less"
        )
    if all(len(group.frames) < 2 for group in groups):
        raise ValueError(
            f"{scanned[0].frame.name}: no other frame has its kind, exposure, "
            "temperature and level (within 5 %): give two that repeat each other"
        )


def transients_of(seen: Seen) -> dict[str, int]:
    """Return how many samples single frames of each group have alone, where any has:
    {"10 darks of 60 s at -5.0 C": 7}."""
    counts = seen.statistics.transients.sum(axis=(1, 2))
    found = {}
    for group, count in zip(seen.groups, counts, strict=True):
        at = "" if group.temperature is None else f" at {group.temperature:.1f} C"
        if count:
            found[f"{len(group.frames)} {group.words}{at}"] = int(count)
    return found
