# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""calibrate: from frames to a Calibration, in the order of the physics.

Flats come first: their system gain tells how noisy a bright pixel of a dark is. Then
darks by exposure: noise, offsets, dark current. Then what flats show above them.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from cg2raw.calibration.darks import cut_share, read_darks
from cg2raw.calibration.defects import defects_of
from cg2raw.calibration.flats import above_darks, read_flats
from cg2raw.calibration.frames import (
    MOST_SATURATED,
    Group,
    Scanned,
    UniformFrame,
    groups_of,
    in_steps,
    scan,
)
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.notes import notes_on
from cg2raw.calibration.one_fit import fitted
from cg2raw.calibration.parts import check_one_chain
from cg2raw.calibration.repeats import Todo, seen_all
from cg2raw.calibration.robust import CENSORED_TO
from cg2raw.calibration.screening import screened
from cg2raw.calibration.sites import sites_of
from cg2raw.calibration.updated_profile import updated_profile
from cg2raw.sensor import Sensor
from cg2raw.statistics.kept import Kept


@dataclass(frozen=True)
class Calibration(Measurements):
    """What calibrate found; see Measurements for its fields."""

    def updated_profile(self, sensor: Sensor | None = None) -> str:
        """Return the JSON of a sensor's profile with what was measured.

        sensor : in place of the one that was calibrated. The black level, the row of
        noise at the frames' ISO and effects that stand out are replaced; effects that
        were looked for and do not are taken out; all else stays.
        Raises ValueError naming field, value and bound."""
        return updated_profile(self, sensor or self.sensor)[0]

    def profile_notes(self) -> list[str]:
        """Return what stands out and cannot be written into a profile."""
        return updated_profile(self, self.sensor)[1]


Progress = Callable[[str, float], None]


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

    At most two frames and about ten maps of a frame's size are held at a time.
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
    dark_groups = [g for g in groups if g.frames[0].frame.kind == "dark"]
    flat_groups = [g for g in groups if g.frames[0].frame.kind == "flat"]
    levels = np.asarray(sensor.black_level, float)
    if dark_groups and cut_share(dark_groups[0]) <= CENSORED_TO:
        levels = dark_groups[0].level
    defects = defects_of(dark_groups, flat_groups, levels, sites, threads)
    todo = Todo(sensor, sites, threads, defects.counting)
    flat_groups.sort(key=lambda group: float(group.level.mean()))
    listed = [*dark_groups, *flat_groups]
    seen = seen_all(todo, listed, lambda x: tell("reading frames", x))
    flats = read_flats(seen, len(dark_groups), levels, lambda x: tell("flats", x))
    gain = flats.first_gain
    tell("fitting", 0.0)
    figures = fitted(seen, flats, float(np.mean(levels)))
    darks = read_darks(seen, dark_groups, gain, figures, lambda x: tell("darks", x))
    light = above_darks(flats, darks, sensor, sites, iso)
    found = Calibration(
        sensor=sensor,
        sites=sites,
        shape=scanned[0].shape,
        iso=iso,
        frames=(number_of(dark_groups), number_of(flat_groups)),
        transients=(*darks.transients, *flats.transients),
        excluded=excluded,
        defects=defects,
        **{k: v for k, v in vars(darks).items() if k != "transients"},
        figures=() if darks.lost else figures,
        **vars(light),
    )
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
        (a, first), (b, second) = list(said.items())[:2]
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
            if found and item.shape != found[0].shape:
                (h, w), (height, width) = item.shape, found[0].shape
                raise ValueError(
                    f"{item.frame.name}: is {w}x{h} pixels, {found[0].frame.name} "
                    f"{width}x{height}: give frames of one size"
                )
            found.append(item)
            tell("looking at frames", len(found) / len(frames))
    return found


def check_groups(groups: Sequence[Group]) -> None:
    """Raise ValueError unless two frames repeat each other, and some are unsaturated,
    and darks of several exposures all say theirs."""
    darks = [g for g in groups if g.frames[0].frame.kind == "dark"]
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


def number_of(groups: Sequence[Group]) -> int:
    """Return how many frames are in groups."""
    return sum(len(group.frames) for group in groups)
