# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""One fit: figures of all frames by one likelihood, beside those of moments."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.calibration.flats import Flats
from cg2raw.calibration.photon_transfer import LINEAR
from cg2raw.calibration.repeats import Seen
from cg2raw.model.figures import Figure, figures_of
from cg2raw.model.fit import fit
from cg2raw.statistics.constant import PIXEL


def fitted(seen: Seen, flats: Flats, black: float) -> Sequence[Figure]:
    """Return the figures of all darks and of flats up to LINEAR of saturation; none
    where no two frames repeat each other.

    black : DN."""
    white = seen.todo.sensor.white_level - black
    most = LINEAR * (flats.ceiling[0].value if flats.ceiling else white)
    unclipped = {id(group) for group in flats.groups}
    used = [
        number
        for number, group in enumerate(seen.groups)
        if group.frames[0].frame.kind == "dark"
        or (id(group) in unclipped and float(group.level.mean()) - black <= most)
    ]
    found = seen.statistics.only([n for n in used if shows_noise(seen, n)])
    if not (found.frames > 1).any():
        return ()
    step = seen.todo.sites.step
    counts = np.sum([plane.codes.sum(axis=0) for plane in found.planes], axis=0)
    of_steps = np.bincount(np.arange(len(counts)) % step, counts)
    offset = int(np.argmax(of_steps))
    found = found.in_steps(step, offset) if step > 1 else found
    return tuple(in_dn(one, step, offset) for one in figures_of(found, fit(found)))


def in_dn(figure: Figure, step: int, offset: int) -> Figure:
    """Return a figure whose unit of codes is a step, DN, from an offset."""
    scale = {"DN": step, "DN/s": step, "e-/DN": 1 / step}.get(figure.unit, 1)
    start = offset if figure.name == "black level" else 0
    value, low, high = (
        start + scale * x for x in (figure.value, figure.low, figure.high)
    )
    error = scale * figure.standard_error
    return replace(figure, value=value, standard_error=error, low=low, high=high)


def shows_noise(seen: Seen, number: int) -> bool:
    """Return whether the frames of a group differ in all planes, or are one."""
    planes = seen.statistics.planes
    is_single = seen.statistics.frames[number] < 2
    return bool(is_single or all(p.scatter[number, PIXEL] > 0 for p in planes))
