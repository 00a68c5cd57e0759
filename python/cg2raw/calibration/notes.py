# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Notes: what frames could not show, which capture would, and what stood out."""

import math
from collections.abc import Iterator, Sequence

from cg2raw.calibration.calibration import STEADY, Calibration
from cg2raw.calibration.defects import words_of
from cg2raw.calibration.fitting import MOST_LOST
from cg2raw.calibration.flats import HIGHEST, LINEAR, LOWEST
from cg2raw.calibration.frames import Scanned
from cg2raw.model.full_well import MOST_CLIPPED
from cg2raw.statistics.codes import hidden

HIGH_MISFIT = 1.5  # of levels about their line, over what drift makes


def notes_on(found: Calibration, scanned: Sequence[Scanned]) -> tuple[str, ...]:
    """Return sentences, each with what would help."""
    return *of_frames(found, scanned), *of_darks(found), *of_flats(found)


def of_frames(found: Calibration, scanned: Sequence[Scanned]) -> Iterator[str]:
    """Yield what is wrong with single frames, and why darks do not show their noise."""
    yield from (f"{name}: {why}: excluded" for name, why in found.excluded.items())
    if found.defects is not None:
        yield words_of(found.defects)
    if (step := found.sites.step) > 1:
        yield (
            f"codes: come in steps of {step} DN, as of fewer bits in the upper ones of "
            f"a word: rounding adds {step}^2 / 12 DN^2 to noise, and the profile has "
            "quantisation"
        )
    if clipped := found.transfer.clipped:
        yield (
            f"{clipped} flats have more than {MOST_CLIPPED:.1%} of pixels at "
            "white, at 0 DN or with a full well: they show saturation and nothing else"
        )
    if found.iso is None:
        yield "ISO: no frame says it, and no noise can be written: give --iso"
    if found.fit.lost == "cut":
        worst = max(scanned, key=lambda item: item.cut)
        is_left = worst.cut <= MOST_LOST
        left = "by the law of what is left of it" if is_left else "the profile's"
        yield (
            f"darks: noise is cut at the lowest code, {worst.cut:.1%} of the pixels of "
            f"{worst.frame.name}: black level and read noise are {left}, all else of "
            "darks is unknown: capture with an offset, if the camera has one"
        )
    if found.fit.lost == "coarse":
        yield (
            f"read noise: below {hidden(found.sites.step):.2g} DN, where rounding "
            "hides it, and with it drift, DSNU and the noise of rows and columns: "
            "capture at a higher ISO or in more bits"
        )


def of_darks(found: Calibration) -> Iterator[str]:
    """Yield what darks could not show."""
    if not found.frames[0]:
        yield "black level: no darks; the profile's is used: capture biases"
    tails, noise = found.tails, found.figure("temporal dark noise")
    if not found.fit.lost and tails is None:
        yield "read noise: needs two darks of one exposure"
    elif tails is not None and tails.excess_kurtosis is None and noise is not None:
        yield (
            f"tails of the read noise: {noise.value:.2f} DN is below {found.sites.step}"
            " DN, a step of the codes, where rounding shapes them: capture at a higher "
            "ISO"
        )
    has_drift = found.figure("black level drift") is not None
    if not found.fit.lost and found.frames[0] and not has_drift:
        yield (
            "black level drift: needs two darks of one exposure; errors of black level "
            "and dark current leave it out"
        )
    if found.frames[0] and found.dark is None and found.fit.lost != "cut":
        yield (
            "dark current, hot pixels, glow: need darks of two exposures: add some as "
            "long as the camera is used for"
        )
    elif found.dark is not None and found.dark.doubling is None:
        yield "doubling temperature: needs long darks at two temperatures, 5 K apart"
    if found.spread is not None and found.spread.has_too_many_hot:
        yield (
            f"hot pixels: {found.spread.hot_words}, where the search ends; the profile "
            "keeps what it said of them: capture cooler or shorter darks"
        )
    if found.fit.misfit > HIGH_MISFIT:
        yield (
            "black level: levels of darks miss their line over exposure time by "
            f"{found.fit.misfit:.1f} times their drift, as where they move between "
            "series or the temperature is not held: the error of the dark current is "
            "widened by that"
        )


def of_flats(found: Calibration) -> Iterator[str]:
    """Yield what flats could not show."""
    if not found.frames[1]:
        yield "gain, PRNU, shading, linearity: no flats: capture some, of many levels"
        return
    transfer, line = found.transfer, found.linearity
    if faint := sum(point.frames for point in transfer.points if point.is_coarse):
        limit = math.sqrt(found.sites.coarse)
        yield (
            f"{faint} flats vary by less than {limit:.2g} DN, by rounding more "
            "than by light: they are in no number: expose more, or at a higher ISO"
        )
    if found.figure("gain") is None:
        yield (
            f"gain: needs two flats of one level below {LINEAR:.0%} of saturation, and "
            "two darks or flats of other levels"
        )
    if transfer.points and transfer.saturation is None:
        yield "full well: no flats reach it: add some, brighter and brighter"
    if found.light is None:
        yield "PRNU, shading: need two flats of one level below saturation"
    elif not found.frames[0]:
        yield "PRNU: without darks the pixels' own offsets count as response"
    if line is None:
        yield "linearity: needs flats of three exposures under one lamp, " + (
            f"{LOWEST:.0%} to {HIGHEST:.0%} of saturation"
        )
    elif line.quadratic.stands_out != (line.bend >= STEADY):
        why, remedy = f"as lamps and shutters may be (below {STEADY:.1%})", ""
        if line.bend >= STEADY:
            why = "but by no curve, as if lamp, aperture or filter changed"
            remedy = "; take flats that differ by exposure time alone"
        yield (
            "linearity: levels are off proportional to exposure time by "
            f"{line.bend:.2%} in the mean, {why}: no nonlinearity is written to the "
            f"profile{remedy}"
        )
