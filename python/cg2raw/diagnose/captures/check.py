# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The check of captures: each frame by itself, then the repeats of a series."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from cg2raw.arrays import RawImage
from cg2raw.calibration import codes
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.diagnose.captures.consistency import dn_per_electron
from cg2raw.diagnose.captures.frame import Frame
from cg2raw.diagnose.captures.quality import Integrity, integrity, of_means
from cg2raw.diagnose.captures.repeats import Series, series_of
from cg2raw.sensor import Sensor

Tracked = Callable[[Sequence[Capture]], Iterable[Capture]]


@dataclass(frozen=True)
class Check:
    """captures : frames and their masked borders, in the manifest's order, with what
    the pixels of each say. complaints, remarks : sentences on series of repeats."""

    captures: Sequence[Capture]
    integrities: Sequence[Integrity]
    complaints: Sequence[str]
    remarks: Sequence[str]

    @property
    def is_right(self) -> bool:
        """Whether nothing is wrong."""
        return not self.complaints and not any(i.complaints for i in self.integrities)


def check(
    frames: Sequence[Frame],
    sensor: Sensor,
    nuisances: Collection[str] = (),
    tracked: Tracked = iter,
) -> Check:
    """Return what all frames' pixels say; each frame is read once.

    tracked : yields the captures it is given, as they are looked at."""
    series = series_of(frames)
    borders = [border for frame in frames for border in frame.borders]
    order = iter(tracked([*(capture for ours in series for capture in ours), *borders]))
    found: dict[str, Integrity] = {}
    complaints: list[str] = []
    remarks: list[str] = []

    def look(capture: Capture) -> RawImage:
        raw = capture.raw()
        found[capture.name] = integrity(replace(capture, raw=lambda: raw), sensor)
        return raw

    for ours in series:
        repeats = Series(ours[0], gain_of(sensor, ours[0]))
        for capture in islice(order, len(ours)):
            repeats.add(capture, look(capture))
        said, more = said_of(repeats, sensor, nuisances)
        complaints += said
        remarks += more
    for border in order:
        look(border)
    for frame in frames:
        if frame.capture.means is not None:
            found[frame.capture.name] = of_means(frame.capture, sensor)
    uniform = [i for i in found.values() if i.kind in ("dark", "flat")]
    words = codes.companded([(i.name, i.mean, i.spacing) for i in uniform])
    complaints += [words] if words else []
    captures = [c for frame in frames for c in (frame.capture, *frame.borders)]
    integrities = [found[capture.name] for capture in captures]
    return Check(captures, integrities, complaints, remarks)


def gain_of(sensor: Sensor, capture: Capture) -> float:
    """Return DN per electron at a capture's ISO; 1 where the profile has no noise."""
    if capture.iso is None or not sensor.noise:
        return 1.0
    return dn_per_electron(sensor, capture.iso)


def said_of(
    series: Series, sensor: Sensor, nuisances: Collection[str]
) -> tuple[list[str], list[str]]:
    """Return (complaints, remarks) on a series whose frames were all read."""
    first = series.first_is_off()
    remarks = [ray] if (ray := series.cosmic_rays()) else []
    if drift := series.lamp_drift(float(np.mean(sensor.black_level))):
        is_free = "light" in nuisances
        remedy = "covers it" if is_free else "would cover it: add it, or effects may"
        tail = "" if is_free else " be named for the lamp's sake"
        remarks.append(f"{drift}, a lamp that drifts; nuisance: [light] {remedy}{tail}")
    return [first] if first else [], remarks
