# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fixed patterns: maps of the sensor, by empirical Bayes from the fit frames.

A map is no free parameter: its prior's variance is estimated from the pixels together,
and the map is the posterior mean. What is uncertain of it goes into the variance.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.frame_offsets import without_shared_offsets
from cg2raw.diagnose.inference.map_evidence import (
    LEAST_INFORMATION,
    Evidence,
    evidence_of,
)
from cg2raw.diagnose.inference.map_prior import prior_of
from cg2raw.diagnose.inference.outliers import FARTHEST
from cg2raw.diagnose.inference.pixel_maps import pixel_maps
from cg2raw.diagnose.inference.sparse_map import fit_sparse_map
from cg2raw.diagnose.inference.spot_map import fit_spot_map
from cg2raw.diagnose.inference.unblended_frames import unblended
from cg2raw.diagnose.inference.variance_map import fit_variance_map
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

MOST_BY_CHANCE = 4.0  # standard errors of a mean of columns
TURNS_OF_MAPS = 3  # of maps of several layouts, by turns, if any is new


def fit_patterns(
    model: Model, likelihood: Likelihood, names: Sequence[str] | None = None
) -> Model:
    """Return the model with the maps of its fixed patterns estimated; of these alone if
    there are names.

    Maps of pixels are estimated together, since the same pixels' offsets, rates and
    gains look alike in few frames; other maps by turns with them. A log-normal law of
    rates says itself which pixels are hot beyond it: few hot pixels come after it."""
    effects = [
        term.effect
        for term in model.terms
        if isinstance(term.effect, FixedPattern) and term.name in (names or [term.name])
    ]
    if not effects:
        return model
    common = likelihood.of(_of_common_shape(likelihood.frames))
    known, chosen = unblended(model, common)
    apart = [effect for effect in effects if effect.layout != "pixels"]
    spots = [[effect.name] for effect in apart if effect.layout == "spots"]
    parts = [[effect.name] for effect in apart if effect.layout != "spots"]
    if of_pixels := [e.name for e in effects if e.layout == "pixels"]:
        first = any(effect.is_log_normal for effect in effects)
        parts.insert(0 if first else len(parts), of_pixels)
    parts = spots + parts
    is_new = any(_is_new(term) for term in model.terms)
    for _ in range(TURNS_OF_MAPS if is_new and len(parts) > 1 else 1):
        shown = without_shared_offsets(known, chosen)
        for together in parts:
            for term in _fitted(known, together, shown):
                known, model = known.with_term(term), model.with_term(term)
    return _made_under_its_noise(model, [effect.name for effect in effects])


def _made_under_its_noise(model: Model, names: Sequence[str]) -> Model:
    """Return the model with its noise written down in the maps of some names."""
    gains = model.noise_gain("beta1"), model.noise_gain("beta2")
    for term in model.terms:
        if term.name in names and term.sensor_map is not None:
            known = replace(term.sensor_map, noise_gains=gains)
            model = model.with_term(replace(term, sensor_map=known))
    return model


def _is_new(term: Term) -> bool:
    """Return whether a map is not known, nor how strong it is."""
    is_map = isinstance(term.effect, FixedPattern)
    return is_map and term.sensor_map is None and not term.values.any()


def _fitted(model: Model, names: Sequence[str], likelihood: Likelihood) -> list[Term]:
    """Return some terms of a model with their maps, estimated together."""
    terms = [term for term in model.terms if term.name in names]
    effects = [term.effect for term in terms if isinstance(term.effect, FixedPattern)]
    rest = model
    for name in [*names, *_would_take_of(effects, model)]:
        rest = rest.without(name)
    if effects[0].layout == "sparse":
        return [fit_sparse_map(terms[0], effects[0], rest, likelihood)]
    if effects[0].layout == "jumps":
        return [fit_variance_map(terms[0], rest, likelihood)]
    shape = likelihood.frames[0].signal.shape
    maps = [term.map_of(shape) for term in terms]
    evidence = evidence_of(effects, rest, likelihood, maps)
    if effects[0].layout == "spots":
        return [fit_spot_map(terms[0], evidence)]
    if effects[0].layout == "columns":
        return [_columns(terms[0], evidence, likelihood.frames[0])]
    of_profile = rest.profile_parameters
    stated = [of_profile.get(t.name) if t.calibration else None for t in terms]
    return pixel_maps(terms, effects, evidence, stated)


def _would_take_of(effects: Sequence[FixedPattern], model: Model) -> list[str]:
    """Return the maps of a model that would take what belongs to others: few hot pixels
    those of a log-normal law, gains of pixels the edges of spots."""
    log_normal = any(effect.is_log_normal for effect in effects)
    spots = effects[0].layout == "spots"
    return [
        term.name
        for term, effect, _ in model.maps
        if (log_normal and effect.layout == "sparse")
        or (spots and effect.layout == "pixels" and effect.acts_on_light)
    ]


def _of_common_shape(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames of the shape of most pixels: masked borders have their own."""
    pixels: dict[tuple[int, ...], int] = {}
    for frame in frames:
        if frame.samples is not None:
            continue
        shape = frame.signal.shape
        pixels[shape] = pixels.get(shape, 0) + int(frame.keep.sum())
    most = max(pixels, key=lambda shape: pixels[shape])
    return [frame for frame in frames if frame.signal.shape == most]


def _columns(term: Term, evidence: Evidence, frame: Frame) -> Term:
    """One offset per column of the frame. What columns of one site of the CFA have in
    common is its black level, and a ramp across all of them that of the bias: neither
    is theirs."""
    tiles = frame.tiles
    information, score = _without_far_pixels(evidence)
    a, b = tiles.over_columns(information), tiles.over_columns(score)
    used = a > 0
    estimate = np.where(used, b / np.maximum(a, LEAST_INFORMATION), 0)
    repeat = round(np.sqrt(int(frame.site.max()) + 1))
    for first in range(repeat):
        same = np.s_[:, :, first::repeat]
        _take_common_part(estimate[same], a[same])
    _take_ramp(estimate, a, tiles.field()[0][:, :1])
    error = 1 / np.maximum(a, LEAST_INFORMATION)
    prior = prior_of((estimate**2)[used], error[used])
    share = prior / (prior + error)
    shape = evidence.score[0].shape
    sensor_map = SensorMap(
        np.broadcast_to(estimate * share, shape),
        np.broadcast_to(np.where(used, error * share, prior), shape),
    )
    return replace(term, values=np.array([np.sqrt(prior)]), sensor_map=sensor_map)


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
