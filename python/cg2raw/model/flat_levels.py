# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The levels of flats of known light: exposure, white balance, greens, a bent response,
crosstalk.

Each has its own pattern over the sites of the CFA and over the light. Several together
can look like another: the set of names is chosen that needs fewest."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.dark_levels import BLACK, DRIFT
from cg2raw.model.fit import Fit
from cg2raw.model.levels import CUT
from cg2raw.model.mean_images import low_of, middle_of
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.model.selection import OF_LENS
from cg2raw.model.shapes.dust import NAME as DUST
from cg2raw.model.smallest_set import SmallestSet, Way, smallest_set
from cg2raw.statistics.constant import PIXEL, Array

FREE = 1e4  # variance of a nuisance that may be anything
LEAST_ERROR = 1e-5  # relative; a profile's own digits
STEP = 1e-6  # of a slope by differences
ROUNDS = 6  # of Gauss-Newton; two are usual
SETTLED = 1e-9  # relative: steps that change nothing
SQUARE = 2  # degree
MATRIX, CROSSTALK = "color_matrix", "crosstalk"
# Shares of other colours that one of two bundled sensors takes in the other's colours.
MATRIX_SHARE = 0.15
ALIKE = 1e-9  # of the largest singular value: directions that others make up for

# Of light that moves from frame to frame, what is slow down the rows.
WAVES = ("lamp, smooth_rows", "mains_flicker, slow_rows")

Change = Callable[["FlatLevels", Array, Array], Array]


@dataclass(frozen=True)
class FlatLevels:
    """ratios : (sites * G,) levels of flats over those that are predicted. covariance :
    of them. predicted : (sites, G), 1 at white. letters : (sites,) of the CFA.
    are_colors_free : each colour of each light may be anything."""

    ratios: Array
    covariance: Array
    predicted: Array
    letters: Array
    are_colors_free: bool = False

    @property
    def side(self) -> int:
        return int(round(len(self.letters) ** 0.5))

    @property
    def names(self) -> list[str]:
        """What such flats can show."""
        of_sides = {1: ("exposure", "nonlinearity"), 2: tuple(CHANGES)}
        some: tuple[str, ...] = ("exposure", "white_balance", "nonlinearity")
        if self.are_colors_free:  # crosstalk would be an imbalance of greens
            of_sides, some = {2: ("gr_gb_imbalance",)}, ()
        return [n for n in CHANGES if n in of_sides.get(self.side, some)]

    def value(
        self, names: Sequence[str], values: Array, known: Array | None = None
    ) -> float:
        """Return the log-likelihood, nats, but for a constant.

        known : (n, n) covariance of the values where they are not given but drawn
        about them, as other frames have told them: that of all such values together
        is likely, and flats of other light are not told more than they can be."""
        rest, slopes, _ = self._system(names, values)
        covariance, more = self.covariance, 0.0
        if known is not None:
            covariance = covariance + slopes.T @ known @ slopes
            before, after = (
                np.linalg.slogdet(one)[1] for one in (self.covariance, covariance)
            )
            more = float(after - before)
        return -(float(rest @ np.linalg.solve(covariance, rest)) + more) / 2

    def fitted(self, names: Sequence[str]) -> Array:
        """Return the likeliest values of the parameters of names, one after the other;
        the smallest of those that are alike."""
        values = np.zeros(sum(CHANGES[name][0] for name in names))
        for _ in range(ROUNDS if len(values) else 0):
            rest, slopes, inverse = self._system(names, values)
            step = inverse @ slopes @ np.linalg.solve(self.covariance, rest)
            values = values + step
            if np.abs(step).max() < SETTLED:
                break
        return values

    def known(self, names: Sequence[str]) -> tuple[Array, Array]:
        """Return what is fitted, and its covariance."""
        values = self.fitted(names)
        return values, self.covariance_of(names, values)

    def covariance_of(self, names: Sequence[str], values: Array) -> Array:
        """Return (n, n) the covariance of values that are fitted."""
        return self._system(names, values)[-1]

    def _system(
        self, names: Sequence[str], values: Array
    ) -> tuple[Array, Array, Array]:
        """Return what values leave of the ratios, the slopes of these, and the inverse
        of Fisher's information."""
        now = self.expected(names, values)
        moved = (values + STEP * one for one in np.eye(len(values)))
        slopes = np.array([self.expected(names, one) - now for one in moved]) / STEP
        slopes = slopes.reshape(len(values), len(now))
        information = slopes @ np.linalg.solve(self.covariance, slopes.T)
        inverse = np.linalg.pinv(information, rcond=ALIKE, hermitian=True)
        return self.ratios - now, slopes, inverse

    def expected(self, names: Sequence[str], values: Array) -> Array:
        """Return the ratios with effects of names, in the order of the physics."""
        level = self.predicted
        given, at = dict[str, Array](), 0
        for name in names:
            count = CHANGES[name][0]
            given[name] = values[at : at + count]
            at += count
        for name, (_, change) in CHANGES.items():
            if name in given:
                level = change(self, level, given[name])
        return (level / self.predicted).ravel()


def _exposure(flats: FlatLevels, level: Array, values: Array) -> Array:
    found: Array = level * (1 + values[0])
    return found


def _white_balance(flats: FlatLevels, level: Array, values: Array) -> Array:
    red, blue = (flats.letters[:, None] == letter for letter in "RB")
    found: Array = level * (1 + values[0] * red + values[1] * blue)
    return found


def _crosstalk(flats: FlatLevels, level: Array, values: Array) -> Array:
    """Both neighbours along a line of a Bayer CFA are of one site."""
    row, column = np.divmod(np.arange(4), 2)
    beside, under = level[2 * row + 1 - column], level[2 * (1 - row) + column]
    found: Array = level + values[0] * (beside - level) + values[1] * (under - level)
    return found


def _gr_gb_imbalance(flats: FlatLevels, level: Array, values: Array) -> Array:
    green, row = flats.letters == "G", np.arange(4) // 2
    in_red_rows = np.isin(row, row[flats.letters == "R"])
    red_row, blue_row = green & in_red_rows, green & ~in_red_rows
    found: Array = level * (1 + values[0] * red_row + values[1] * blue_row)[:, None]
    return found


def _nonlinearity(flats: FlatLevels, level: Array, values: Array) -> Array:
    found: Array = level - values[0] * level**2 - values[1] * level**3
    return found


# Numbers of parameters, and what they do to (sites, G) levels.
CHANGES: Mapping[str, tuple[int, Change]] = {
    "exposure": (1, _exposure),
    "white_balance": (2, _white_balance),
    CROSSTALK: (2, _crosstalk),
    "gr_gb_imbalance": (2, _gr_gb_imbalance),
    "nonlinearity": (2, _nonlinearity),
}


def flat_levels(
    found: Fit,
    predicted: Array,
    cfa: str,
    *,
    white: float,
    light: float,
    nuisances: frozenset[str],
    named: Collection[str],
    doubted: Collection[str],
    shaded: Array,
    unseen_dust: float,
    greys: Array,
) -> FlatLevels | None:
    """Return the levels of flats; None if there are none.

    predicted : (sites, G) DN above black, nan of darks, 0 of unknown light, of which
    only what sites of one colour differ by is told. cfa : the letters of its repeat,
    row by row. white : DN above black. light : relative, how far each frame's may be
    off. nuisances : of a capture set. named : effects that there are: where light falls
    off towards the corners, levels are those of the middle of the frame. doubted : what
    is too weak to be named or not shown, and may be there: light that falls off by the
    square of the distance from the middle; a black level of each site that may be
    anything; one that drifts by the read noise from frame to frame; a colour matrix,
    which shows where flats are not grey; dust, of which @unseen_dust of all light may
    be in none of its spots. shaded : (sites,) the mean of a stated
    shading, which mean images lack, over that in the middle. greys : as @predicted, of
    grey light; 1 of each without."""
    predicted = predicted * shaded[:, None]
    planes = found.likelihood.planes
    is_cut = np.any([plane.plane.high > CUT for plane in planes], axis=0)
    is_lit = np.all([plane.light > 0 for plane in planes], axis=0)
    groups = np.flatnonzero((predicted >= 0).all(axis=0) & is_lit & ~is_cut)
    if not len(groups):
        return None
    light_of = np.array([plane.light[groups] for plane in planes])
    letters = np.array(list(cfa))
    is_known = np.asarray((predicted[:, groups] > 0).all(axis=0))
    alike = np.equal.outer(letters, letters)
    of_color = alike @ light_of / alike.sum(axis=1, keepdims=True)
    predicted = np.where(is_known, predicted[:, groups], of_color)
    frames = planes[0].frames[groups]
    noise = [plane.level_noise(found.theta) for plane in planes]
    variance = np.array([pixel[groups] + lines[groups] for pixel, lines in noise])
    covariance = np.diag((variance / frames / light_of**2).ravel() + LEAST_ERROR**2)
    own, count = found.parameters.each("black_level"), len(planes)
    blacks = found.covariance[own, own]
    blacks = np.where(np.isfinite(blacks), blacks, 0.0)
    site = np.repeat(np.arange(count), len(groups))
    flat = np.tile(np.arange(len(groups)), count)
    of_site, one_light = 1 / light_of.ravel(), np.equal.outer(flat, flat)
    of_sites = np.outer(of_site, of_site)
    covariance += of_sites * blacks[np.ix_(site, site)]
    if BLACK in doubted:
        covariance += of_sites * np.equal.outer(site, site) * white**2
    if DRIFT in doubted:
        read = found.theta[found.parameters.each("read_noise")].mean()
        covariance += of_sites * one_light * read / frames[flat]
    if MATRIX in doubted:
        mixed = MATRIX_SHARE * _mixed(predicted / greys[:, groups], letters)
        covariance += mixed.T @ mixed
    if DUST in doubted:
        covariance += unseen_dust**2
    drift = max(float(found.theta[found.parameters.of("black_level_drift")]), 0.0)
    covariance += of_sites * one_light * drift / frames[flat]
    # The mean of the pixels' sensitivity is not quite 1.
    prnu = max(float(found.theta[found.parameters.of("prnu")]), 0.0)
    one_site = np.equal.outer(site, site)
    covariance += one_site * prnu / planes[0].plane.masked.size
    color = letters[site]
    one_color = one_light * np.equal.outer(color, color)
    covariance += FREE * one_color * ~is_known[flat]
    covariance += one_light * light**2 / frames[flat]
    # A wave down the rows has a mean, as large as its other coefficients are.
    waves = [found.theta[found.parameters.of(name)] for name in WAVES]
    wave = float(np.maximum(waves, 0.0).sum()) / planes[0].plane.masked.size
    covariance += one_light * wave / frames[flat]
    if "exposure" in nuisances:
        covariance += FREE * one_light
    if "white_balance" in nuisances:
        covariance += FREE * one_color
    ratios = light_of / predicted
    if falls_off := {*OF_LENS} & {*named, *doubted}:
        degree = SQUARE if falls_off & {*doubted} else None
        brighter, more = _middles(
            planes, groups, light_of, OF_LENS[1] in falls_off, found.theta, degree
        )
        ratios = ratios * (1 + (brighter * shaded)[:, None])
        covariance += more[np.ix_(site, site)]
    ratios = ratios.ravel()
    are_free = "white_balance" in nuisances or not is_known.any()
    return FlatLevels(ratios, covariance, predicted / white, letters, are_free)


def _mixed(balanced: Array, letters: NDArray[np.str_]) -> Array:
    """Return (n, sites * G) by how much the share of another colour that one takes to
    itself moves ratios. balanced : (sites, G) levels, alike of all colours of grey."""
    found = []
    for own, other in permutations(sorted(set(letters)), 2):
        taken = balanced[letters == other].mean(axis=0) / balanced - 1
        found.append((taken * (letters == own)[:, None]).ravel())
    return np.array(found).reshape(len(found), balanced.size)


def _middles(
    planes: Sequence[PlaneLikelihood],
    groups: NDArray[np.int64],
    light: Array,
    is_colored: bool,
    theta: Array,
    degree: int | None,
) -> tuple[Array, Array]:
    """Return (sites,) how much brighter the middle is than the mean, relative, and the
    covariance of that. Where light slopes, sites differ by their places. degree : as of
    middle_of."""
    side, count = planes[0].side, len(planes)
    values, variances, moved = (np.zeros(light.shape) for _ in range(3))
    for site, plane in enumerate(planes):
        low = low_of(plane.plane, site, side)
        above, samples = middle_of(plane.plane, low, degree)
        values[site] = above[groups] / light[site]
        level = low[groups, 0, 0] / np.sqrt(plane.plane.masked.size)
        moved[site] = level / light[site]
        noise = (
            plane.usual_scatter(theta)[groups, PIXEL] / plane.frames[groups] / samples
        )
        variances[site] = noise / light[site] ** 2
    axis = 1 if is_colored else None
    total = (1 / variances).sum(axis=axis)
    mean = np.broadcast_to((values / variances).sum(axis=axis) / total, count)
    alike = np.eye(count) if is_colored else np.ones((count, count))
    mean = mean + np.average(moved, axis=1, weights=1 / variances[0])
    return mean, alike * np.broadcast_to(1 / total, count)


def levels_set(
    training: FlatLevels, validation: FlatLevels, least: float
) -> SmallestSet:
    """Return the set of names that explains levels best: nats on validation frames with
    its parameters as trained, over the same set without the name, fitted anew. None in
    which pixels take light from their neighbours, beyond chance.

    least : nats that a name needs."""

    def value(names: Sequence[str], trained: tuple[Array, Array]) -> float:
        if CROSSTALK in names:
            first = sum(CHANGES[one][0] for one in names[: names.index(CROSSTALK)])
            own = slice(first, first + CHANGES[CROSSTALK][0])
            variances = np.maximum(np.diagonal(trained[1])[own], 0.0)
            if (trained[0][own] < -np.sqrt(2 * least * variances) - LEAST_ERROR).any():
                return -np.inf
        return validation.value(names, *trained)

    way = Way(
        training.known,
        value,
        lambda names: validation.value(names, validation.fitted(names)),
    )
    return smallest_set(dict.fromkeys(validation.names, 0), least, [way])
