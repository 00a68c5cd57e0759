# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pruning: what of a model of many effects the held-out frames need.

One effect is dropped at a time, all others are fitted again without it, and the select
frames say what that costs: the evidence for the effect, with all others in place. What
a few tiles of large frames miss by far is needed: all of them would miss it more.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from cg2raw.diagnose.inference.fisher_scoring import Linearisation, one_step
from cg2raw.diagnose.inference.fitting import first_guess, fit, fit_alone
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

BEYOND_DOUBT = 100.0  # thresholds, from where on the model without it need not move
BY_FAR = 3.0  # thresholds that a few tiles lose, of what all are sure to miss
MOST_DOUBTED = 1000.0  # nats, of what is missed whatever moves beside one effect
LEAST_CHANGE = 1e-3  # nats, of a model without an effect that predicts anything
TURNS_WITHOUT = 1  # of a fit without one effect, which starts at that with it


@dataclass(frozen=True)
class Pruned:
    """A model of the effects that are needed. losses : nats that the select frames lose
    without each of them. dropped : the same of the others, in order."""

    model: Model
    losses: dict[str, float]
    dropped: dict[str, float]


def pruned(
    model: Model,
    splits: Splits,
    threshold: float,
    report: Callable[[str], None] = lambda text: None,
) -> Pruned:
    """Return a model without the effects that gain less than a threshold, nats.

    Once others are dropped, what is not needed beyond doubt is asked for again, and so
    is what a few tiles miss: beside others that stand in for each other, a fit without
    an effect stops short, and misses it."""
    losses: dict[str, float] = {}
    dropped: dict[str, float] = {}
    while True:
        unknown = [name for name in model.found_names if name not in losses]
        sure = missed_by_few(model, splits, unknown, threshold, report)
        found = _pruned(model, splits, threshold, losses | sure, report)
        if not found.dropped:
            return replace(found, dropped=dropped)
        model, dropped = found.model, dropped | found.dropped
        losses = {
            name: loss
            for name, loss in found.losses.items()
            if name not in sure and loss > BEYOND_DOUBT * threshold
        }


def _pruned(
    model: Model,
    splits: Splits,
    threshold: float,
    losses: dict[str, float],
    report: Callable[[str], None],
) -> Pruned:
    """Return a model without the effects that gain less than a threshold on all tiles.
    losses : of the effects that are known to be needed."""
    losses, dropped = dict(losses), dict[str, float]()
    while True:
        unknown = [name for name in model.found_names if name not in losses]
        model = fit(model, splits.fit, TURNS_WITHOUT) if unknown else model
        rests = _without_each(model, unknown, splits.select)
        for name in _idle(rests, splits.select.total(model)):
            model, dropped[name] = model.without(name), 0.0
            del rests[name]
        least_first = sorted(rests, key=lambda name: -rests[name])
        model, asked = _without_one(model, least_first, splits, threshold, report)
        needed = {name: loss for name, loss in asked.items() if loss >= threshold}
        losses |= needed
        if asked == needed:
            return Pruned(model, losses, dropped)
        dropped |= {name: loss for name, loss in asked.items() if name not in needed}


def _without_one(
    model: Model,
    names: Sequence[str],
    splits: Splits,
    threshold: float,
    report: Callable[[str], None],
) -> tuple[Model, dict[str, float]]:
    """Return (the model without the first of some effects that is not needed, what the
    select frames lose, nats, without each that was asked for, that one last)."""
    height, later = splits.select.total(model), None
    losses: dict[str, float] = {}
    for name in names:
        report(f"is {name} needed")
        rest = fit(model.without(name), splits.fit, TURNS_WITHOUT)
        loss = _lost(height, rest, splits, threshold)
        if threshold <= loss < BEYOND_DOUBT * threshold:
            later = later or _turned(model, splits)
            loss = _lost(later, rest, splits, threshold)
        if loss < threshold:
            again = restarted(model, name, rest, splits, threshold)
            above = splits.select.total(again) if again is not model else height
            loss = _lost(above, rest, splits, threshold)
            model, height, later = again, above, None
        losses[name] = loss
        if loss < threshold:
            return rest, losses
    return model, losses


def _turned(model: Model, splits: Splits) -> float:
    """Return the height of a model, nats, after the turn that it gets without one of
    its effects: of a model that is not settled that alone is a loss or a gain."""
    return splits.select.total(fit(model, splits.fit, TURNS_WITHOUT))


def _lost(height: float, rest: Model, splits: Splits, threshold: float) -> float:
    """Return what the select frames lose by a model without an effect, less what it
    gains by moving there, where that may decide.

    height : nats with the effect."""
    loss = height - splits.select.total(rest)
    if loss < BEYOND_DOUBT * threshold:
        loss -= _gain_there(rest, splits.select)
    return loss


def missed_beside(
    model: Model, splits: Splits, names: Collection[str], newest: str
) -> set[str]:
    """Return which of the effects the select frames miss by far, though the newest one
    does what it can in their place."""
    chosen = splits.few or splits
    model = model.of_few_tiles(splits.frames)
    height = chosen.select.total(model)
    rests = {n: fit_alone(model.without(n), newest, chosen.fit) for n in names}
    losses = {n: height - chosen.select.total(rest) for n, rest in rests.items()}
    return {name for name, loss in losses.items() if loss > MOST_DOUBTED}


def missed_by_few(
    model: Model,
    splits: Splits,
    names: Collection[str],
    threshold: float,
    report: Callable[[str], None] = lambda text: None,
) -> dict[str, float]:
    """Return what the select frames would lose, nats, without each of the effects that
    a few tiles miss by far, all others fitted again; nothing where frames are small.

    names : of the effects that are looked at. threshold : nats that a name gains."""
    few = splits.few
    if few is None or not names:
        return {}
    share = few.select.pixels / splits.select.pixels
    of_few = fit(model.of_few_tiles(splits.frames), few.fit, TURNS_WITHOUT)
    height = _turned(of_few, few)
    rests = _without_each(of_few, names, few.select)
    idle = _idle(rests, few.select.total(of_few))
    losses = {}
    for name in names:
        if name in idle:
            continue
        report(f"is {name} needed")
        rest = fit(of_few.without(name), few.fit, TURNS_WITHOUT)
        loss = height - few.select.total(rest)
        if loss > BY_FAR * threshold:
            losses[name] = loss / share
    return losses


def _without_each(
    model: Model, names: Collection[str], select: Likelihood
) -> dict[str, float]:
    """Return the height of a model, nats, without each of some effects, by name."""
    return {name: select.total(model.without(name)) for name in names}


def _idle(rests: Mapping[str, float], height: float) -> list[str]:
    """Return which effects predict nothing: a fit has left them at none.

    rests : heights, nats, without each of them. height : with all."""
    return [name for name, rest in rests.items() if abs(rest - height) < LEAST_CHANGE]


def _gain_there(model: Model, select: Likelihood) -> float:
    """Return what a model gains on the select frames by fitting itself to them."""
    base = Linearisation(model, select)
    return one_step(model, base, base.height)[1]


def restarted(
    model: Model, name: str, rest: Model, splits: Splits, least: float
) -> Model:
    """Return the model with an effect that starts from data started anew beside the
    others, if that is better: before they were found it may have stood in for them.

    rest : the model without it. least : nats that the select frames must gain."""
    term = model.term(name)
    if term is None or not term.effect.starts_from_data:
        return model
    guess = first_guess(term.effect, Linearisation(rest, splits.fit))
    if guess is None:
        return model
    again = fit(guess[0], splits.fit)
    gain = splits.select.total(again) - splits.select.total(model)
    return again if gain > least else model
