# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Fixed patterns: maps of the sensor, by empirical Bayes from the fit frames.

A map is no free parameter: its prior's variance is estimated from the pixels together,
and the map is the posterior mean. What is uncertain of it goes into the variance.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from cg2raw.diagnose.effects.dark_current import RATES
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern, Layout
from cg2raw.diagnose.effects.hot_pixels import HOT_PIXELS
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.column_map import fit_column_map
from cg2raw.diagnose.inference.frame_offsets import without_shared_offsets
from cg2raw.diagnose.inference.map_evidence import evidence_of
from cg2raw.diagnose.inference.map_prior import Stated
from cg2raw.diagnose.inference.pixel_maps import pixel_maps
from cg2raw.diagnose.inference.sparse_map import fit_sparse_map
from cg2raw.diagnose.inference.spot_map import fit_spot_map
from cg2raw.diagnose.inference.unblended_frames import unblended
from cg2raw.diagnose.inference.variance_map import fit_variance_map
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term

TURNS_OF_MAPS = 3  # of maps of several layouts, by turns, if any is new


def fit_patterns(
    model: Model, likelihood: Likelihood, names: Sequence[str] | None = None
) -> Model:
    """Return the model with the maps of its fixed patterns estimated; of these alone if
    there are names.

    Maps of pixels are estimated together, since the same pixels' offsets, rates and
    gains look alike in few frames; other maps by turns with them."""
    effects = [
        term.effect
        for term in model.terms
        if isinstance(term.effect, FixedPattern) and term.name in (names or [term.name])
    ]
    if not effects:
        return model
    common = likelihood.of(_of_common_shape(likelihood.frames))
    known, chosen = unblended(model, common)
    parts, every = _in_turn(effects), [effect.name for effect in effects]
    is_new = any(_is_new(term) for term in model.terms)
    for _ in range(TURNS_OF_MAPS if is_new and len(parts) > 1 else 1):
        shown = without_shared_offsets(known, chosen)
        for together in parts:
            for term in _fitted(known, together, every, shown):
                known, model = known.with_term(term), model.with_term(term)
    return _made_under_its_noise(model, every)


def _in_turn(effects: Sequence[FixedPattern]) -> list[list[str]]:
    """Return names of maps, those together that are estimated so.

    What many pixels share comes before what is their own. A log-normal law of rates
    says itself which pixels are hot beyond it: few hot pixels come after it."""
    of_few: list[Layout] = ["sparse", "jumps"]
    law_first = any(effect.is_log_normal for effect in effects)
    last = ["pixels", *of_few] if law_first else [*of_few, "pixels"]
    parts = []
    for layout in ("spots", "columns", *last):
        names = [effect.name for effect in effects if effect.layout == layout]
        parts += [names] if layout == "pixels" and names else [[n] for n in names]
    return parts


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


def _fitted(
    model: Model, names: Sequence[str], every: Collection[str], likelihood: Likelihood
) -> list[Term]:
    """Return some terms of a model with their maps, estimated together. every : that
    are estimated, before these and after."""
    terms = [term for term in model.terms if term.name in names]
    effects = [term.effect for term in terms if isinstance(term.effect, FixedPattern)]
    others = _would_take_of(effects, model, every)
    rest = model
    for name in [*names, *others]:
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
        said, tiles = _stated(terms[0], model), likelihood.frames[0].tiles
        own = [model.term(name) for name in others]
        beside = sum(float(one.values[0]) ** 2 for one in own if one is not None)
        return [fit_column_map(terms[0], evidence, tiles, said, beside)]
    stated = [_stated(term, model) for term in terms]
    return pixel_maps(terms, effects, evidence, stated)


def _stated(term: Term, model: Model) -> Stated | None:
    """Return what a profile says of a map's law, and of the pixels that are hot beyond
    it; None where it says nothing, or not what the map's is.

    Of rates it says nothing at another temperature: not all pixels' grow alike with
    it."""
    effect, said = term.effect, model.profile_parameters.get(term.name)
    if model.by_temperature and term.name in RATES:
        return None
    log_normal = isinstance(effect, FixedPattern) and effect.is_log_normal
    hot = model.term(HOT_PIXELS) if log_normal else None
    of_hot = None if hot is None else _stated(hot, model)
    numbers = said if said is not None and term.calibration else {}
    return Stated(numbers, term.held, of_hot) if numbers or of_hot else None


def _would_take_of(
    effects: Sequence[FixedPattern], model: Model, every: Collection[str]
) -> list[str]:
    """Return the maps of a model that would take what belongs to others: few hot pixels
    those of a log-normal law, gains of pixels the edges of spots, and offsets of pixels
    what they share in columns, if they are estimated after these."""
    log_normal = any(effect.is_log_normal for effect in effects)
    spots = effects[0].layout == "spots"
    columns = effects[0].layout == "columns"
    return [
        term.name
        for term, effect, _ in model.maps
        if (log_normal and effect.layout == "sparse")
        or (spots and effect.layout == "pixels" and effect.acts_on_light)
        or (columns and effect.is_offset and term.name in every)
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
