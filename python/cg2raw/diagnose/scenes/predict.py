# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""predict(): what a model says of a frame, effects by the registry."""

from collections.abc import Iterator, Mapping, Sequence
from operator import is_

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.cfa import sites_of
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.scenes.model import Model

PREDICTED = "predicted"  # in the memo of a frame
BAYER, MONO = 4, 1  # sites of their repeats


def registry_values(model: Model, frame: Frame) -> list[tuple[str, list[float]]]:
    """Return all effects that the registry simulates for a model, with values.

    The registry's noises have one parameter per site of a Bayer CFA, one without
    filters; `predict` adds those of others, and the variance of fixed patterns; offsets
    that pixels share are no variance, but integrated out (point.offsets_of)."""
    effects = every()
    listed = {
        name: values
        for name, values in _values_of(model).items()
        if not isinstance(effects[name], FixedPattern)
        and not effects[name].whitens_variance
    }
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
        part.astype(float) for part in _known_by_registry(model, frame, values)
    )
    charge = pattern_mean(model, frame)
    mean, exposed = mean + charge, exposed + charge
    gain = photon_gain(model, frame)
    variance = variance + gain * charge
    photon_variance = gain * np.maximum(exposed, 0)
    if len(sites_of(model.sensor.cfa)) not in (BAYER, MONO):
        read_variance = model.noise_gain("beta2") * frame.beta2
        variance = variance + photon_variance + read_variance
    well = Well.of(dict(values), exposed, photon_variance)
    variance = variance / variance_left(model) + sum(
        pattern_variances(model, frame, exposed).values()
    )
    if well is not None:
        lost = well.cut
        mean, variance = mean - lost[0], variance - lost[1]
    # Noise that blending has in common lies at low frequencies, as effects do: there
    # its density is that before the blending.
    variance = np.maximum(variance, LEAST_VARIANCE)
    variance = variance + frame.rounding / frame.range**2
    if frame.samples is not None:
        variance = _of_means(frame, variance, frame.samples)
        photon_variance = photon_variance / frame.samples
    third = sum(
        effect.pattern_third_cumulant(stated, frame.seconds)
        for effect, stated in patterns(model)
    )
    return Prediction(mean, variance, exposed, photon_variance, well, third)


def pattern_variances(
    model: Model, frame: Frame, exposed: Array
) -> dict[str, Array | float]:
    """Return the variance of each fixed pattern that a profile states: no image says
    what each pixel has of it."""
    light = np.maximum(exposed, 0) * frame.capture.shows.light
    return {
        effect.name: effect.pattern_variance(stated, light, frame.seconds)
        for effect, stated in patterns(model)
    }


def pattern_mean(model: Model, frame: Frame) -> float:
    """Return the mean of these patterns."""
    return sum(
        effect.pattern_mean(stated, frame.seconds) for effect, stated in patterns(model)
    )


def patterns(model: Model) -> Iterator[tuple[FixedPattern, Mapping[str, float]]]:
    """Yield the fixed patterns that a profile states, with their parameters."""
    for name, stated in model.profile_parameters.items():
        if isinstance(effect := every()[name], FixedPattern):
            yield effect, stated


def _known_by_registry(
    model: Model, frame: Frame, values: list[tuple[str, list[float]]]
) -> Sequence[NDArray[np.float32]]:
    """Return what `by_registry` does; what was asked for last is kept."""
    given = model.sensor, frame.camera, frame.glare_context
    key = frame.seconds, tuple((name, tuple(each)) for name, each in values)
    known = frame.memo.get(PREDICTED)
    if known and known[0] == key and all(map(is_, known[1], given)):
        predicted: Sequence[NDArray[np.float32]] = known[2]
        return predicted
    predicted = by_registry(model, frame, values)
    frame.memo[PREDICTED] = key, given, predicted
    return predicted


def by_registry(
    model: Model,
    frame: Frame,
    values: Sequence[tuple[str, list[float]]],
    camera: NDArray[np.float32] | None = None,
) -> Sequence[NDArray[np.float32]]:
    """Return (mean, variance, exposed) of a frame by the registry's effects.

    camera : in the place of the frame's."""
    return _core.predict_blocks(
        model.sensor.profile,
        values,
        frame.camera if camera is None else camera,
        frame.tiles.origins,
        frame.tiles.shape,
        frame.tiles.margin,
        frame.neutral,
        frame.seconds,
        frame.glare_context,
    )


def variance_left(model: Model) -> float:
    """Return what a model's blending of pixels leaves of the variance of noise."""
    left = 1.0
    for name, values in _values_of(model).items():
        left *= every()[name].variance_left(np.array(values))
    return left


def _values_of(model: Model) -> dict[str, list[float]]:
    """Return the values of effects that a profile states or that move a mean."""
    listed = {n: [*stated.values()] for n, stated in model.profile_parameters.items()}
    for term in model.terms:
        if term.effect.predicted:
            old = np.array(listed.get(term.name, term.effect.null))
            bounded = term.effect.within_registry_bounds(old + term.values)
            listed[term.name] = bounded.tolist()
    return listed


def _of_means(frame: Frame, variance: Array, samples: Array) -> Array:
    """Return the variance of means of pixels of this variance, which lie in a square
    whose rows have offsets of their own."""
    of_rows = sum(offset_variances(frame).values())
    return np.asarray(variance / samples + of_rows / np.sqrt(samples))


def offset_variances(frame: Frame) -> dict[str, float]:
    """Return the variance of each offset that pixels share, by the profile."""
    found = {}
    for name, values in frame.noise.drawn.items():
        effect = every()[name]
        if isinstance(effect, SharedOffset):
            found[name] = effect.offset_variance(np.array(values), frame)
    return found


def photon_gain(model: Model, frame: Frame) -> Array:
    """Return the variance of light per signal, (h, w)."""
    return model.noise_gain("beta1") * frame.beta1
