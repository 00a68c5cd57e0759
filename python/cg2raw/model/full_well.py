# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Full well: flats in which more light brings less noise.

Charge that a well does not hold takes its shot noise along. Source: EMVA Standard 1288,
release 4.0, saturation capacity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.evaluation import Parameters
from cg2raw.statistics.codes import COARSE
from cg2raw.statistics.constant import (
    PIXEL,
    Array,
    ConstantStatistics,
    PlaneStatistics,
)

NAME = "full_well"
CEILING = 0.5  # of the largest variance of darker flats; below it the well is full
CERTAIN = 4.0  # standard errors that a block's variance is below it
NOTHING = 0.01  # of a profile's shot noise, that a flat without any may have
NONE = 1e-9  # DN^2, of noise that nobody knows
MOST_CLIPPED = 0.002  # of the pixels of a flat that still counts (EMVA 1288)


@dataclass(frozen=True)
class FullWell:
    """groups : numbers of the flats in which wells are full. level : DN above black, of
    a full well; error : its standard error. nats : of the split that says less,
    against half of the noise that darker flats have; most : of all flats."""

    groups: tuple[int, ...]
    level: float
    error: float
    nats: float
    most: float = 0.0


class _Blocks(NamedTuple):
    """Of all flats at one site, from dark to bright: DN above black, DN^2 of noise and
    its standard error, numbers of groups."""

    level: Array
    noise: Array
    error: Array
    group: NDArray[np.int64]


def full_well(
    statistics: ConstantStatistics,
    splits: Sequence[str],
    profile: Array,
    has_noise: bool,
    least: float,
) -> FullWell | None:
    """Return where wells are full; None if nowhere.

    splits : to train and to validate by. profile : (n,) parameters. has_noise : whether
    the profile has: then a flat without any shot noise is full, whatever others are.
    least : nats that a name needs."""
    parameters = Parameters(len(statistics.planes))
    darks = statistics.shortest_darks()
    groups, levels = list[NDArray[np.int64]](), list[Array]()
    nats, most = dict.fromkeys(splits, 0.0), 0.0
    tried = float(np.log(sum(plane.noise.size for plane in statistics.planes)))
    flats = np.flatnonzero(statistics.is_flat)
    repeated = flats[statistics.pairs[flats] > 0]
    used = (repeated if len(repeated) else flats).tolist()
    measured = {g: _measured(statistics, g) for g in used}
    noises = {g: _noise_of(statistics, g) for g in (*used, *darks)}
    for site, plane in enumerate(statistics.planes):
        black, read, gain = (
            float(profile[parameters.of(name, site)])
            for name in ("black_level", "read_noise", "gain")
        )
        if len(darks):
            black = float(plane.level[darks].mean())
            read = np.mean([noises[g][site] for g in darks])
        shown = {g: one for g, one in measured.items() if noises[g][site] > COARSE}
        blocks = _blocks_of(plane, site, black, shown)
        law = gain * blocks.level if has_noise else 0 * blocks.level
        each = _nats_of_less(blocks, read, law)
        is_full = each > least + tried
        groups.append(blocks.group[is_full])
        levels.append(blocks.level[is_full])
        most += float(each[is_full].sum())
        for split in splits:
            own = statistics.splits[blocks.group] == split
            nats[split] += float(each[is_full & own].sum())
    full = np.unique(np.concatenate([np.zeros(0, int), *groups]))
    if not len(full):
        return None
    highest = np.concatenate(levels)
    # In blocks that are full in part, the mean is that of others, too.
    highest = highest[highest >= np.quantile(highest, 0.5)]
    return FullWell(
        tuple(map(int, full)),
        float(highest.mean()),
        float(max(highest.std(), 0.5)),
        max(min(nats.values()) - tried, 0.0),
        most,
    )


def _noise_of(statistics: ConstantStatistics, number: int) -> Array:
    """Return (planes,) DN^2, variances of a frame of a group; of one without pairs,
    those of its pixels, patterns included."""
    if not statistics.pairs[number]:
        return statistics.variance(number)
    return np.array([plane.power[number] for plane in statistics.planes])


def _measured(statistics: ConstantStatistics, number: int) -> tuple[Array, ...]:
    """Return (planes, n) levels, DN, variances of noise, DN^2, and their relative
    errors, of the blocks of a group; of one without pairs as a whole."""
    if statistics.pairs[number]:
        return statistics.block_levels(number), *statistics.block_noise(number)
    levels = np.array([[plane.level[number]] for plane in statistics.planes])
    freedom = np.array([[plane.freedom[PIXEL]] for plane in statistics.planes])
    errors = np.sqrt(2 / np.maximum(freedom, 1))
    return levels, _noise_of(statistics, number)[:, None], errors


def _blocks_of(
    plane: PlaneStatistics, site: int, black: float, measured: Mapping[int, Any]
) -> _Blocks:
    """Return the blocks of a site's flats that white does not clip. measured : of
    flats, as of _measured."""
    each = [
        (
            level[site] - black,
            noise[site],
            error[site] * noise[site],
            0 * noise[site] + g,
        )
        for g, (level, noise, error) in measured.items()
        if plane.high[g] + plane.low[g] <= MOST_CLIPPED
    ]
    level, noise, error, group = np.concatenate([np.zeros((4, 0)), *each], axis=1)
    known = np.flatnonzero(noise > 0)
    order = known[np.argsort(level[known], kind="stable")]
    return _Blocks(level[order], noise[order], error[order], group[order].astype(int))


def _nats_of_less(blocks: _Blocks, read: float, law: Array) -> Array:
    """Return how certain it is that light brings less than half of the noise that it
    does where it is darker, nats of each block; 0 where it does not. It is less than
    half of a profile's only where a flat has the noise of darks.

    read : DN^2, of darks. law : of a profile; 0 without."""
    doubt = CERTAIN * blocks.error
    sure = np.maximum.accumulate(blocks.noise - read - doubt)
    darker = np.maximum(np.concatenate([[0.0], sure[:-1]]), 0.0)
    freedom = 2 * (blocks.noise / blocks.error) ** 2
    less, none = (
        _nats_below(blocks.noise / np.maximum(read + CEILING * usual, NONE), freedom)
        for usual in (darker, law)
    )
    # Of flats as a whole: light's noise, its error, and what a profile says of it.
    count, noise, variance, usual = (
        np.bincount(blocks.group, each)[blocks.group]
        for each in (np.ones_like(law), blocks.noise, blocks.error**2, law)
    )
    error = CERTAIN * np.sqrt(variance) / count
    is_dark = np.abs(noise / count - read) < np.maximum(error, NOTHING * usual / count)
    found: Array = np.maximum(less, np.where(is_dark, none, 0.0))
    return found


def _nats_below(ratio: Array, freedom: Array) -> Array:
    """Return minus the logarithm of a bound on the chance that a mean square is as far
    below its expectation; 0 above it. Source: H. Chernoff, Ann. Math. Stat. 23(4),
    1952."""
    found: Array = np.where(ratio < 1, freedom / 2 * (ratio - 1 - np.log(ratio)), 0.0)
    return found
