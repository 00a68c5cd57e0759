# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Swaps: an effect of a model exchanged for one that looks alike."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import confusable
from cg2raw.diagnose.inference.candidates import told_by_pixels
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.splits import LUCK, Splits
from cg2raw.diagnose.inference.ties import CLEAR
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
    found = []
    for old, candidates in _alike(model, names, effects, known):
        few = splits.few
        if few is not None:
            of_few = model.of_few_tiles(splits.frames)
            candidates = [
                one
                for one in candidates
                if _may_gain(_swapped(of_few, old, [one], few, report))
            ]
        for swap, _ in _swapped(model, old, candidates, splits, report):
            found.append(swap)
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
) -> Iterator[tuple[Swap, float]]:
    """Yield swaps of an effect for each of others, but those that come nowhere near,
    with the standard error of the gain."""
    height = splits.select.in_blocks(model)
    rest = model.without(old)
    loss = height.sum() - splits.select.total(rest)
    base = Linearisation(rest, splits.fit)
    for candidate in candidates:
        report(f"would {candidate.name} do as well as {old}")
        guess = first_guess(candidate, base)
        if guess is None:
            continue
        lost = height.sum() - splits.select.total(guess[0])
        if lost > NEAR * abs(loss) + NEARBY_NATS:
            continue
        fitted = fit(guess[0], splits.fit)
        if told_by_pixels(fitted, candidate.name, splits.select) < CLEAR:
            continue
        gained = splits.select.in_blocks(fitted) - height
        error = float(gained.std() * np.sqrt(gained.size))
        yield Swap(float(gained.sum()), old, candidate.name, fitted), error


def _may_gain(few: Iterator[tuple[Swap, float]]) -> bool:
    """Return whether any swap gains on a few tiles, or might on all of them."""
    return any(swap.gain + LUCK * error > 0 for swap, error in few)
