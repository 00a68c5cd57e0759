# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""predict(): what a model says of a frame, effects by the registry, then maps."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from operator import is_

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.cfa import sites_of
from cg2raw.diagnose.effects.base import Effect, Values, WhiteningStage
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sensor_map import SensorMap
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.response import Response
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.likelihood.full_wells import cut_by_well
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.tails import variance_for_means

LEAST_VARIANCE_LEFT = (
    0.15  # of a variance, that is left without what fit frames made of a map
)
PREDICTED = "predicted"  # in the memo of a frame
BAYER, MONO = 4, 1  # sites of their repeats


def registry_values(model: Model, frame: Frame) -> list[tuple[str, list[float]]]:
    """Return all effects that the registry simulates for a model, with values.

    The registry's noises have one parameter per site of a Bayer CFA, one without
    filters; `predict` adds those of others. It draws maps of its own, and no sensor has
    those; offsets that pixels share are no variance, but whitened."""
    effects = every()
    listed = {
        name: list(stated.values())
        for name, stated in model.warm_parameters.items()
        if effects[name].estimator != "fixed pattern"
        and not effects[name].whitens_variance
    }
    for term in model.terms:
        if term.effect.predicted:
            old = np.array(listed.get(term.name, term.effect.null))
            bounded = term.effect.within_registry_bounds(
                term.effect.added(old, term.values)
            )
            listed[term.name] = bounded.tolist()
    sites = len(sites_of(model.sensor.cfa))
    if sites not in (BAYER, MONO):
        return list(listed.items())
    betas_of = {"beta1": frame.noise.beta1, "beta2": frame.noise.beta2}
    for effect in effects.values():
        if effect.scales:
            betas, factor = betas_of[effect.scales], model.noise_gain(effect.scales)
            spread = betas if len(betas) > 1 else betas * sites
            listed[effect.name] = [min(factor * beta, 1.0) for beta in spread]
    return list(listed.items())


def predict(model: Model, frame: Frame) -> Prediction:
    """Return what a model predicts of a frame."""
    values = registry_values(model, frame)
    mean, variance, exposed = (
        part.astype(float) for part in _by_registry(model, frame, values)
    )
    gain = photon_gain(model, frame)
    photon_variance = gain * np.maximum(exposed, 0)
    if len(sites_of(model.sensor.cfa)) not in (BAYER, MONO):
        read_variance = model.noise_gain("beta2") * frame.beta2
        variance = variance + photon_variance + read_variance
    well = Well.of(dict(values), exposed, photon_variance)
    response = Response.of(dict(values), exposed)
    slopes = {t.name: e.slope(frame, exposed, response) for t, e, _ in model.maps}
    left = np.prod([e.variance_left(values) for e, values in blending(model, frame)])
    unblended = mean, variance / left
    *with_maps, kept, well = _with_maps(
        model, frame, *unblended, exposed, gain, well, slopes
    )
    mean = mean + _blended(model, frame, with_maps[0] - mean)
    variance = left * with_maps[1]
    variance = np.maximum(variance, LEAST_VARIANCE) + frame.rounding / frame.range**2
    if frame.samples is not None:
        variance = _of_means(model, frame, variance, frame.samples)
        photon_variance = photon_variance / frame.samples
    unknown: Array | float = 0.0
    shrinking = None
    if (nuisance := model.nuisance) is not None:
        unknown = nuisance.pixel_variance(frame, variance)
        shrinking = partial(nuisance.shrinkage, frame=frame)
    return Prediction(
        mean,
        variance + unknown,
        exposed,
        photon_variance,
        unknown,
        shrinking=shrinking,
        well=well,
        response=response,
        kept=kept,
        jumps=sum(known.mean for known in maps_of_jumps(model, frame)),
    )


def maps_of_jumps(model: Model, frame: Frame) -> Iterator[SensorMap]:
    """Yield the maps of variance that whitening has."""
    for _, effect, _ in model.maps:
        known = model.map_on(effect, frame) if effect.whitens_variance else None
        if known is not None:
            yield known


def mean_without_maps(model: Model, frame: Frame) -> Array:
    """Return the mean that a model predicts of a frame but for its maps."""
    return _by_registry(model, frame, registry_values(model, frame))[0].astype(float)


def _by_registry(
    model: Model, frame: Frame, values: list[tuple[str, list[float]]]
) -> Sequence[NDArray[np.float32]]:
    """Return (mean, variance, exposed) without maps. What was asked for last is known:
    maps and noise that is whitened change none of it."""
    given = model.sensor, frame.camera, frame.glare_context
    key = frame.seconds, tuple((name, tuple(each)) for name, each in values)
    known = frame.memo.get(PREDICTED)
    if known and known[0] == key and all(map(is_, known[1], given)):
        predicted: Sequence[NDArray[np.float32]] = known[2]
        return predicted
    predicted = _core.predict_blocks(
        model.sensor.profile,
        values,
        frame.camera,
        frame.tiles.origins,
        frame.tiles.shape,
        frame.tiles.margin,
        frame.neutral,
        frame.seconds,
        frame.glare_context,
    )
    frame.memo[PREDICTED] = key, given, predicted
    return predicted


def _with_maps(
    model: Model,
    frame: Frame,
    mean: Array,
    variance: Array,
    exposed: Array,
    gain: Array,
    well: Well | None,
    slopes: Mapping[str, Array | float],
) -> tuple[Array, Array, Array | float, Well | None]:
    """Return (mean, variance, what is kept of noise, full well) with the maps of fixed
    patterns: what acts before a pixel is full shows as likely as it is not.

    The fit frames made the maps: their residuals are too small by the maps' variance.
    Of a hot pixel it is mostly not known whether it is one, which makes none smaller.
    """
    fitted = frame.capture.group == "fit"
    below: Array | float = 1.0
    if well is not None:
        mean, variance, well = cut_by_well(
            model, frame, mean, variance, gain, well, slopes
        )
        below = well.below
    doubt: Array | float = 0.0
    charge = exposed
    for term, effect, sensor_map in model.maps:
        sensitivity = slopes[term.name]
        if effect.whitens_variance:
            continue
        if sensor_map.mean.shape != mean.shape:  # elsewhere the map is not known
            variance = variance + (sensitivity * sensor_map.spread) ** 2
            continue
        shift = sensitivity * sensor_map.mean
        mean = mean + shift
        sensitivity = sensitivity * (below if effect.fills_well else 1.0)
        unsure = _unsure(model, effect, sensor_map, sensitivity, slopes, fitted)
        if effect.is_charge:
            more = np.maximum(charge + shift, 0) - np.maximum(charge, 0)
            charge = charge + shift
            if effect.is_log_normal and fitted:
                # Alike in all pixels: weights that a skewed map has a part in would
                # pull the mean to the side of its smaller values.
                if (weights := frame.keep * sensor_map.share).any():
                    doubt = doubt + np.average(unsure - gain * more, weights=weights)
                continue
            variance = variance + gain * more
        if effect.layout != "sparse":
            doubt = doubt + unsure
        elif not fitted:
            variance = variance + unsure
    if fitted:
        surely_below = True if well is None else well.surely_below
        variance, kept = _of_makers(model, frame, charge, variance, doubt, surely_below)
        return mean, variance, kept, well
    least = LEAST_VARIANCE_LEFT * variance
    return mean, np.maximum(variance + doubt, least), 1.0, well


def _hot(model: Model, shape: tuple[int, ...]) -> Array:
    """Return the rates of hot pixels by the maps of a model."""
    rates = np.zeros(shape)
    for _, effect, known in model.maps:
        if effect.layout == "sparse" and known.mean.shape == shape:
            rates += known.mean
    return rates


def _unsure(
    model: Model,
    effect: FixedPattern,
    sensor_map: SensorMap,
    sensitivity: Array | float,
    slopes: Mapping[str, Array | float],
    fitted: bool,
) -> Array:
    """Return the variance of a map in a frame, with what errors of others have in
    common with its own."""
    unsure = sensitivity**2 * variance_of_map(model, effect, sensor_map, fitted)
    for name, covariance in sensor_map.covariance.items():
        unsure = unsure + sensitivity * slopes.get(name, 0.0) * covariance
    return unsure


def variance_of_map(
    model: Model, effect: FixedPattern, sensor_map: SensorMap, fitted: bool
) -> Array:
    """Return that of each pixel beside the other maps of a model. What is not of a law
    is of hot pixels, as far as these make up for it; wholly, if the frame is one that
    made the maps."""
    variance = sensor_map.variance
    if effect.is_log_normal:
        shape = sensor_map.mean.shape
        known = 1.0 if fitted else sensor_map.made_up(_hot(model, shape))
        variance = variance - known * sensor_map.unsure_kind
    return variance


def _of_makers(
    model: Model,
    frame: Frame,
    charge: Array,
    variance: Array,
    doubt: Array | float,
    surely_below: Mask | bool,
) -> tuple[Array, Array]:
    """Return (variance of residuals of a frame that maps were made of, what is kept of
    its noise there).

    A map follows a frame's noise by a leverage, the map's variance over that by which
    the noise told of it: the residual is what is left of this noise, and of how far the
    map would be off without this frame. That does not change with what the noise is
    taken for afterwards; else a frame that made its own map would outweigh those that
    tell noise. Source: R. D. Cook, S. Weisberg, Residuals and Influence in
    Regression, 1982, section 2.2.

    doubt : variance of the maps in the frame. surely_below : where a pixel is not full:
        a map is made of no other."""
    made = variance
    gains = [known.noise_gains for _, _, known in model.maps if known.noise_gains]
    if gains:
        now = model.noise_gain("beta1"), model.noise_gain("beta2")
        of_light, of_readout = np.subtract(gains[0], now)
        made = made + of_light * frame.beta1 * np.maximum(charge, 0)
        made = made + of_readout * frame.beta2
    made = variance_for_means(model, frame, made)
    leverage = doubt / np.maximum(made, LEAST_VARIANCE)
    leverage = np.clip(leverage, 0, 1 - LEAST_VARIANCE_LEFT)
    leverage = np.where(surely_below, leverage, 0.0)
    left = 1 - leverage
    of_makers = left * (left * variance + leverage * made)
    unsure = variance + np.maximum(doubt, 0)
    return np.where(surely_below, of_makers, unsure), left**2


def _blended(model: Model, frame: Frame, of_maps: Array) -> Array:
    """Return what maps add to a mean, as a camera blends all of an image."""
    for effect, values in blending(model, frame):
        of_maps = effect.blended(of_maps, values)
    return of_maps


def blending(model: Model, frame: Frame) -> Iterator[tuple[Effect, Values]]:
    """Yield the effects of a model that blend neighbours, with their values."""
    for effect in every().values():
        if effect.whitening is WhiteningStage.FILTER:
            values = model.values_of(effect, frame)
            if values is not None and np.any(values):
                yield effect, values


def _of_means(model: Model, frame: Frame, variance: Array, samples: Array) -> Array:
    """Return the variance of means of pixels of this variance, which lie in a square
    whose rows have offsets of their own."""
    of_rows = 0.0
    for effect in every().values():
        if isinstance(effect, SharedOffset):
            values = model.values_of(effect, frame)
            if values is not None:
                of_rows += effect.offset_variance(values, frame)
    return np.asarray(variance / samples + of_rows / np.sqrt(samples))


def photon_gain(model: Model, frame: Frame) -> Array:
    """Return the variance of light per signal, (h, w)."""
    return model.noise_gain("beta1") * frame.beta1


def shot_noise_left_out(model: Model, frame: Frame, p: Prediction) -> Array:
    """Return the variance that the charge of log-normal maps adds to each pixel of a
    frame that made them, (T, h, w): a prediction of it has that alike in all."""
    charge = np.zeros_like(p.mean)
    if frame.capture.group == "fit":
        for _, effect, known in model.maps:
            if effect.is_log_normal and known.mean.shape == charge.shape:
                charge += effect.sensitivity(frame, p.exposed) * known.mean
    more = np.maximum(p.exposed + charge, 0) - np.maximum(p.exposed, 0)
    shot_noise = np.sqrt(p.kept) * photon_gain(model, frame) * more
    return np.asarray(np.maximum(shot_noise, (LEAST_VARIANCE_LEFT - 1) * p.variance))
