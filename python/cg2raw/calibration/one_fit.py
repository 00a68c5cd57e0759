# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""One fit: figures of all frames by one likelihood, beside those of moments."""

from collections.abc import Sequence

from cg2raw.calibration.flats import Flats
from cg2raw.calibration.photon_transfer import LINEAR
from cg2raw.calibration.repeats import PIXEL, Seen
from cg2raw.model.figures import Figure, figures_of
from cg2raw.model.fit import fit


def fitted(seen: Seen, flats: Flats, black: float) -> Sequence[Figure]:
    """Return the figures of all darks and of flats up to LINEAR of saturation; none
    where no two frames repeat each other, or where codes come in steps.

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
    if seen.todo.sites.step > 1 or not (found.frames > 1).any():
        return ()
    return tuple(figures_of(found, fit(found)))


def shows_noise(seen: Seen, number: int) -> bool:
    """Return whether the frames of a group differ in all planes, or are one."""
    planes = seen.statistics.planes
    is_single = seen.statistics.frames[number] < 2
    return bool(is_single or all(p.scatter[number, PIXEL] > 0 for p in planes))
