# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Column map: an offset of each column, and how much columns differ.

How much is said by what columns have beside their neighbours: what is slow across them
is of the bias, but for what no ramp and no edge describes. The map has that as well.
"""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.frames.tiling import Array, Mask, Tiling
from cg2raw.diagnose.inference.map_evidence import LEAST_INFORMATION, Evidence
from cg2raw.diagnose.inference.map_prior import Stated, lost_by_variance, prior_of
from cg2raw.diagnose.inference.outliers import FARTHEST
from cg2raw.diagnose.inference.slow_part import SMOOTH, smoothed
from cg2raw.diagnose.likelihood.model import Term

MOST_BY_CHANCE = 4.0  # standard errors of a mean of columns
# Of white noise's variance, that columns have left without their slow part.
KEPT_OF_COLUMNS = 1 - (2 - np.sqrt(0.5)) / (np.sqrt(2 * np.pi) * SMOOTH)


def fit_column_map(
    term: Term,
    evidence: Evidence,
    tiles: Tiling,
    stated: Stated | None = None,
    beside: float = 0.0,
) -> Term:
    """Return the term with its map: one offset per column of the frame.

    What columns of one site of the CFA have in common is its black level, and a ramp
    across all of them that of the bias: neither is theirs. stated : what a profile says
    of their deviation. beside : variance of the offsets of pixels, which are estimated
    when these are known: what is too much in one is too little in the other."""
    information, score = _without_far_pixels(evidence.beside_offsets(beside))
    a, b = tiles.over_columns(information), tiles.over_columns(score)
    alone = tiles.over_columns(evidence.information[0, 0] * (information > 0))
    used = a > 0
    estimate = np.where(used, b / np.maximum(a, LEAST_INFORMATION), 0)
    for first in range(evidence.repeat):
        same = np.s_[:, :, first :: evidence.repeat]
        _take_common_part(estimate[same], a[same])
    _take_ramp(estimate, a, tiles.field()[0][:, :1])
    error = 1 / np.maximum(a, LEAST_INFORMATION)
    own = _own_variance(estimate, error, used, evidence.repeat)
    lost = 0.0
    if stated is not None:
        said = stated.numbers["sigma"] ** 2
        lost = lost_by_variance(said, own, error[used])
        if stated.holds(lost, evidence.known(0).sum()):
            own, lost = said, 0.0
    # The slow part is as large as it is, whatever columns differ by beside it.
    prior = own + prior_of((estimate**2)[used], error[used] + own)
    share = prior / (prior + error)
    shape = evidence.score[0].shape
    sensor_map = SensorMap(
        np.broadcast_to(estimate * share, shape),
        np.broadcast_to(prior / (1 + prior * alone), shape),
    )
    values = np.array([np.sqrt(own)])
    return replace(term, values=values, sensor_map=sensor_map, contradicted=lost)


def _own_variance(estimate: Array, error: Array, used: Mask, repeat: int) -> float:
    """Return the variance of columns beside their neighbours."""
    told, rest = used / error, np.zeros_like(estimate)
    for first in range(repeat):
        same = np.s_[:, :, first::repeat]
        rest[same] = estimate[same] - smoothed(estimate[same], told[same])
    return prior_of((rest**2 / KEPT_OF_COLUMNS)[used], error[used])


def _without_far_pixels(evidence: Evidence) -> tuple[Array, Array]:
    """Return (information, score) of columns without pixels that lie far from the rest
    of theirs: what a cosmic ray left of them in other maps is no column's."""
    information, score = evidence.information[0, 0], evidence.score[0]
    known = evidence.known(0)
    estimate = np.where(known, score / np.where(known, information, 1), np.nan)
    empty = ~known.any(1, keepdims=True)
    middle = np.nanmedian(np.where(empty, 0, estimate), axis=1, keepdims=True)
    near = known & ((estimate - middle) ** 2 * information < FARTHEST**2)
    return information * near, score * near


def _take_common_part(estimate: Array, information: Array) -> None:
    """Take from columns, in place, the mean of them, if it is more than columns that
    differ as these do have by chance."""
    used = information > 0
    if used.sum() < 2:
        return
    mean = float(np.average(estimate[used], weights=information[used]))
    own = (estimate[used] - mean) ** 2
    chance = np.sqrt(own.mean() / used.sum())
    if abs(mean) > MOST_BY_CHANCE * chance:
        estimate[used] -= mean


def _take_ramp(estimate: Array, information: Array, place: Array) -> None:
    """Take from columns, in place, the line across them, on the same condition. place :
    of each column, in any unit."""
    used = information > 0
    if used.sum() < 3:
        return
    weight = information[used] / information[used].sum()
    value = estimate[used] - weight @ estimate[used]
    across = place[used] - weight @ place[used]
    slope = float((weight * across) @ value / ((weight * across) @ across))
    chance = np.sqrt((value**2).mean() / (across**2).sum())
    if abs(slope) > MOST_BY_CHANCE * chance:
        estimate[used] -= slope * across
