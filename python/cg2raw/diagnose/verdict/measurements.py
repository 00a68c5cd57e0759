# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What calibrate measures of shapes, of frames that the diagnosis has read."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.calibration import Calibration
from cg2raw.calibration.darks import DarkResults, read_darks
from cg2raw.calibration.fitting import Fitted, lost_of, with_levels
from cg2raw.calibration.flats import Light, light_of
from cg2raw.calibration.seen import Seen
from cg2raw.calibration.sites import sites_of
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.darks_and_flats import DarksAndFlats
from cg2raw.model.figures import Figure, figures_of
from cg2raw.model.fit import SAME_LIGHT
from cg2raw.statistics.dark_rates import dark_rates
from cg2raw.statistics.frame_statistics import MOST_CUT


def measurements_of(found: DarksAndFlats, wanted: Collection[str]) -> Calibration:
    """Return what training and validation frames together show of effects; of others,
    what the fit has. wanted : names of the effects."""
    seen = _seen(found)
    lost, _ = lost_of(seen)
    fit = Fitted(_figures(found, wanted), lost=lost)
    sensor, capture = found.captures.sensor, found.frames.captures[0]
    measured = Calibration(
        sensor=sensor,
        sites=seen.sites,
        shape=capture.shape,
        iso=capture.iso,
        frames=(0, 0),
        fit=fit,
    )
    black = measured.black
    darks = read_darks(seen, fit, black)
    if "amplifier_glow" not in wanted:  # no glow is taken off the dark current
        darks = replace(darks, glow=None)
    light = _light(seen, black, darks) if "lens_shading" in wanted else None
    return replace(measured, **vars(darks), light=light)


def _figures(found: DarksAndFlats, wanted: Collection[str]) -> list[Figure]:
    """Return the figures of the fit, a black level that is wanted by the shortest darks
    alone."""
    both = found.statistics.of_splits(GROUPS[:2])
    figures, shortest = figures_of(both, found.both), both.shortest_darks()
    darks = sum(group.kind == "dark" for group in both.groups)
    if "black_level" in wanted and 0 < len(shortest) < darks:
        return with_levels(figures, both.only(shortest.tolist()))
    return figures


def _seen(found: DarksAndFlats) -> Seen:
    """Return training and validation frames as one set of darks and flats."""
    both = found.as_taken.of_splits(GROUPS[:2])
    order = sorted(
        range(len(both.groups)),
        key=lambda n: (both.groups[n].kind, both.groups[n].exposure_time or 0.0),
    )
    both = both.only(order)
    groups = tuple(replace(info, split="") for info in both.groups)
    both = replace(both, groups=groups)
    sensor = found.captures.sensor
    return Seen(sensor, sites_of(sensor), (), replace(both, rates=dark_rates(both)))


def _light(seen: Seen, black: NDArray[np.float64], darks: DarkResults) -> Light | None:
    """Return the response of the brightest flats that are not clipped."""
    flats = range(len(seen.darks), len(seen.statistics.groups))
    levels = {n: float(seen.levels(n).mean() - black.mean()) for n in flats}
    levels = {n: x for n, x in levels.items() if seen.clipped(n) <= MOST_CUT}
    least = max(levels.values(), default=0.0) / (1 + SAME_LIGHT)
    brightest = [n for n, level in levels.items() if level >= least > 0]
    return light_of(seen, brightest, black, darks)[0] if brightest else None
