# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Swaps: an effect of a model exchanged for one that looks alike."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import confusable
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model

NEAR, NEARBY_NATS = 0.5, 50.0  # of what is lost, and beyond it, that a fit may make up


@dataclass(frozen=True)
class Swap:
    """A model with a new effect in an old one's place. gain : of the select frames."""

    gain: float
    old: str
    new: str
    model: Model


def best_swap(
    model: Model,
    effects: Sequence[Effect],
    splits: Splits,
    names: Collection[str],
    known: Collection[tuple[str, str]],
    report: Callable[[str], None],
) -> Swap | None:
    """Return the swap that gains most, of effects that look alike; None if there is
    nothing to swap.

    names : of those that may be exchanged. known : pairs that were swapped, and are not
    swapped back."""
    found: list[Swap] = []
    for old, candidates in _alike(model, names, effects, known):
        found += _swapped(model, old, candidates, splits, report)
    return max(found, key=lambda swap: swap.gain, default=None)


def _alike(
    model: Model,
    names: Collection[str],
    effects: Sequence[Effect],
    known: Collection[tuple[str, str]],
) -> Iterator[tuple[str, list[Effect]]]:
    """Yield names of effects of a model with others that look alike."""
    for term in model.terms:
        if term.name not in names:
            continue
        others = [
            one
            for one in effects
            if one.name not in model.names
            and not {(term.name, one.name), (one.name, term.name)} & set(known)
            and confusable(term.effect, one)
        ]
        if others:
            yield term.name, others


def _swapped(
    model: Model,
    old: str,
    candidates: Sequence[Effect],
    splits: Splits,
    report: Callable[[str], None],
) -> Iterator[Swap]:
    """Yield swaps of an effect for each of others, but those that come nowhere near."""
    height = splits.select.total(model)
    rest = model.without(old)
    loss = height - splits.select.total(rest)
    base = Linearisation(rest, splits.fit)
    for candidate in candidates:
        report(f"would {candidate.name} do as well as {old}")
        guess = first_guess(candidate, base)
        if guess is None:
            continue
        lost = height - splits.select.total(guess[0])
        if lost > NEAR * abs(loss) + NEARBY_NATS:
            continue
        fitted = fit(guess[0], splits.fit)
        gained = splits.select.total(fitted) - height
        yield Swap(gained, old, candidate.name, fitted)
