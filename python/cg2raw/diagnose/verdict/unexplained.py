# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What no effect explains: which part of the frames, where, and whether it matters."""

from collections.abc import Iterator, Mapping, Sequence
from math import exp, log, sqrt

from scipy.special import chdtr, chdtrc, ndtr

from cg2raw.diagnose.diagnosis import (
    CHI_SQUARE,
    CHI_SQUARE_ERRORS,
    CHI_SQUARE_NAME,
    LARGE_NATS,
    LARGE_P,
    LEAST_NATS,
    SHARE_LEFT,
    STRUCTURE,
    ResidualTest,
)
from cg2raw.model.fit import Fit
from cg2raw.model.full_well import FullWell
from cg2raw.model.likelihood import Misfit, misfits
from cg2raw.model.selection import SPOTS
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.patterns import Spots

# Parts of frames (statistics.constant.PARTS) in words.
PLACES: Mapping[str, str] = {
    "smooth_rows": "gradients down the frame",
    "smooth_columns": "gradients across the frame",
    "slow_rows": "broad bands of rows",
    "slow_columns": "broad bands of columns",
    "fast_rows": "rows",
    "fast_columns": "columns",
    "field": "broad patches",
    "pixel": "single pixels",
}
# Components that no effect has (model.selection.UNNAMED, SPOTS) in words.
COMPONENTS: Mapping[str, str] = {
    "column_noise": "columns differ, anew in every frame",
    "row_fixed_pattern": "rows differ, the same in all darks and flats",
    "columns of light": "columns differ in proportion to light, the same in all flats",
    "rows of light": "rows differ in proportion to light, the same in all flats",
    SPOTS: "round spots are darker, the same in all flats, and not of the "
    "shape of dust",
}


def left_over(tests: Sequence[ResidualTest], gained: float) -> list[ResidualTest]:
    """Return the tests that say that something is left, of a model that closed so many
    nats per pixel."""
    least = max(LEAST_NATS, SHARE_LEFT * gained)
    return [
        test
        for test in tests
        if (test.p_value < STRUCTURE / len(tests) and test.nats_per_pixel > least)
        or (test.p_value < LARGE_P and test.nats_per_pixel > LARGE_NATS)
    ]


def chi_square_test(
    chi_square: float, freedom: float, gained: float
) -> list[ResidualTest]:
    """Return the test of the reduced chi-square of held-out frames, of so many degrees
    of freedom, if it is not near 1 and not SHARE_LEFT of what a model closed, nats per
    pixel."""
    error = sqrt(2 / max(freedom, 1))
    away = chi_square - 1
    nats = 0.5 * abs(away - log(chi_square))
    is_near = abs(away) <= max(CHI_SQUARE, CHI_SQUARE_ERRORS * error)
    if is_near or nats <= SHARE_LEFT * gained:
        return []
    text = "larger" if away > 0 else "smaller"
    return [
        ResidualTest(
            CHI_SQUARE_NAME,
            chi_square,
            float(2 * ndtr(-abs(away) / error)),
            nats,
            f"the residuals are {text} than the noise that is predicted",
        )
    ]


def tests_of(held_out: Fit, fitted: Fit, samples: int) -> list[ResidualTest]:
    """Return the test of each part of held-out frames by the parameters of others.

    held_out : the likelihood of these frames, of so many samples, at parameters that
    they did not fit. fitted : the fit of the others: its own error adds to theirs, by
    their number over that of its frames."""
    frames = [one.likelihood.planes[0].frames.sum() for one in (held_out, fitted)]
    share = 1 / (1 + frames[0] / frames[1])
    groups = held_out.likelihood.means.statistics.groups
    return [
        _test(one, groups[one.group], share, samples)
        for one in misfits(held_out.likelihood, held_out.theta)
    ]


def _test(one: Misfit, group: GroupInfo, share: float, samples: int) -> ResidualTest:
    """share : of the freedom that the error of the fit leaves."""
    freedom, squares = one.freedom * share, one.squares * share
    p_value = 2 * min(chdtrc(freedom, squares), chdtr(freedom, squares), 0.5)
    away = one.ratio - 1
    text = f"{abs(away):.1%} {'more' if away > 0 else 'less'} variance than predicted "
    if one.what == "noise":
        text += f"from frame to frame in {PLACES[one.part]} of {described(group)}"
    else:
        text += f"among {PLACES[one.part]} of mean frames, most in {described(group)}"
    name = f"{one.what} of {PLACES[one.part]}"
    if one.what == "noise":
        name += f", {described(group)}"
    return ResidualTest(name, away, float(p_value), one.nats / samples, text)


def described(group: GroupInfo) -> str:
    """Return what frames of a group are: "darks of 60 s"."""
    time = f" of {group.exposure_time:.4g} s" if group.exposure_time is not None else ""
    return f"{group.kind}s{time}"


def unnamed_tests(
    unnamed: Mapping[str, float], samples: int, spots: Spots | None = None
) -> Iterator[ResidualTest]:
    """Yield a test of each component that no effect has. unnamed : nats that each gains
    on validation frames, of so many samples. spots : those of flats."""
    for name, nats in unnamed.items():
        where = COMPONENTS[name]
        if name == SPOTS and spots is not None:
            row, column, _ = max(spots.places, key=lambda place: float(place[2]))
            where += f"; the largest of {len(spots.places)} is at row {row:.0f}, "
            where += f"column {column:.0f}"
        yield _of_nats(name, nats, nats, samples, where)


def full_well_test(well: FullWell, samples: int) -> ResidualTest:
    """Return the test of wells that are full and are not named."""
    where = f"light brings no more noise from {well.level:.0f} DN above black on"
    return _of_nats("full wells", well.level, well.most, samples, where)


def _of_nats(
    name: str, statistic: float, nats: float, samples: int, where: str
) -> ResidualTest:
    gain = max(nats, 0.0)
    chance = exp(-min(gain, 700.0))  # about the least of a float
    return ResidualTest(name, statistic, chance, gain / samples, where)
