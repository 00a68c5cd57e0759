# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Selection: which effects scenes show, from two small matrices.

All effects are fitted on training scenes, and the cheapest is dropped while validation
scenes lose less than a name must be worth; then exchanges. A gain on frames that did
not fit it is the log of an e-value: L. Wasserman et al., PNAS 117(29), 2020.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations

import numpy as np
from scipy.special import chdtrc

from cg2raw.diagnose.scenes.gram import Array, Gram, Space
from cg2raw.normal import ABOVE95

Names = frozenset[str]
UNDERFLOWS = 1000.0  # chi-square, whose chance is then below 1e-200


@dataclass(frozen=True)
class Chosen:
    """names : best first. nats : what validation scenes lose without each. alike : sets
    of other effects that would do as well, by name; one class. instead : the best other
    effect in its place, and what validation scenes gain by that."""

    names: Sequence[str]
    nats: Mapping[str, float]
    alike: Mapping[str, Sequence[tuple[str, ...]]]
    instead: Mapping[str, tuple[str, float]] = field(default_factory=dict)


class Selection:
    """Chooses among the effects of a space.

    train : with what is known of parameters. least : nats that a name needs. alpha :
    chance of a false first name. known : effects that are fitted beside all others."""

    def __init__(
        self,
        space: Space,
        train: Gram,
        validation: Gram,
        least: float,
        alpha: float,
        known: Collection[str] = (),
    ) -> None:
        self._space, self._train, self._validation = space, train, validation
        self._known = frozenset(known)
        self.least = least
        self._exchange = math.log(1 / alpha)
        self._score = cache(self._of)

    def _of(self, names: Names) -> float:
        fitted = self._train.fit(self._space.index(names | self._known))
        return self._validation.gain(fitted)

    def _lost_without(self, names: Names) -> dict[str, float]:
        """Return what validation scenes lose without each name, if what fixed patterns
        make of it in all scenes alike, and the chance of that, takes its place."""
        lost = {}
        index = self._space.index(names | self._known)
        for name in sorted(names):
            pulled = self._train.with_patterns(self._space, name)
            if pulled is None:
                lost[name] = self._score(names) - self._score(names - {name})
                continue
            theta = pulled.fit(index)
            at = np.ix_(own := self._space.index([name]), own)
            known = pulled.information[at] - self._train.information[at]
            chance = _log_chance(float(theta[own] @ known @ theta[own]), len(own))
            lost[name] = self._score(names) - self._validation.gain(theta) - chance
        return lost

    def nats(self, name: str, names: Collection[str]) -> float:
        """Return what validation scenes lose without one of some names."""
        return self._score(frozenset(names)) - self._score(frozenset(names) - {name})

    def run(self, candidates: Collection[str], most: int) -> Chosen:
        """Return the effects chosen of some candidates, at most so many."""
        score, every = self._score, frozenset(candidates)
        starts = [self._pruned(every), self._grown(every)]
        found = [self._exchanged(one, every) for one in starts]
        names = max(found, key=self._worth)
        while names:
            lost = self._lost_without(names)
            least = min(sorted(names), key=lambda a: lost[a])
            if lost[least] >= self.least:
                break
            names -= {least}
        while len(names) > most:
            names = max((names - {a} for a in sorted(names)), key=score)
        nats = {a: score(names) - score(names - {a}) for a in sorted(names)}
        first = sorted(nats, key=lambda a: -nats[a])
        instead = {}
        for a in names if every - names else ():
            rest = names - {a}
            b = max(sorted(every - names), key=lambda b: score(rest | {b}))
            instead[a] = b, score(rest | {b}) - score(rest)
        return Chosen(first, nats, self._alike(names, every), instead)

    def _worth(self, names: Names) -> float:
        return self._score(names) - self.least * len(names)

    def _grown(self, every: Names) -> Names:
        """Add what is worth most while that is more than a name must be, and drop what
        others explain since: a few names may stand for what one explains."""
        names: Names = frozenset()
        for _ in every:
            best = max((names | {a} for a in sorted(every)), key=self._worth)
            if self._worth(best) <= self._worth(names):
                break
            names = self._pruned(best)
        return names

    def _exchanged(self, names: Names, every: Names) -> Names:
        """Exchange names, or take in others, while that pays."""
        score = self._score
        for _ in every:
            out = every - names
            moves = {names | {b}: self.least for b in sorted(out)}
            for a in sorted(names):
                moves |= {names - {a} | {b}: self._exchange for b in sorted(out)}
            best = max(moves, key=lambda one: score(one) - moves[one], default=names)
            if best == names or score(best) - moves[best] < score(names):
                break
            names = self._pruned(best)
        return names

    def _pruned(self, names: Names) -> Names:
        """Drop the cheapest while it is worth less than a name must be."""
        while names:
            rest = max((names - {a} for a in sorted(names)), key=self._score)
            if self._score(names) - self._score(rest) >= self.least:
                break
            names = rest
        return names

    def _alike(self, names: Names, every: Names) -> dict[str, list[tuple[str, ...]]]:
        """Return, per name, the effects or pairs of them that do as well on all
        scenes, but for a nat of each parameter that they have less. Source: H. Akaike,
        IEEE Trans. Autom. Control 19(6), 1974."""
        both = self._train + self._validation

        def size(some: Names) -> int:
            return len(self._space.index(some))

        def score(some: Names) -> float:
            return both.gain(both.fit(self._space.index(some | self._known)))

        free = sorted(every - names)
        found: dict[str, list[tuple[str, ...]]] = {}
        for a in sorted(names):
            rest, least = names - {a}, score(names) - self._exchange
            same = [
                some
                for k in (1, 2)
                for some in combinations(free, k)
                if score(rest | {*some})
                > least - max(size(frozenset({a})) - size(frozenset(some)), 0)
            ]
            found[a] = [s for s in same if not any(set(t) < set(s) for t in same)]
        return found


def _log_chance(square: float, freedom: int) -> float:
    """Return the logarithm of the chance that chi-square is as large; where a float
    does not hold that, by the first term of its series."""
    if square < UNDERFLOWS:
        return math.log(chdtrc(freedom, max(square, 0.0)))
    half = square / 2
    return (freedom / 2 - 1) * math.log(half) - half - math.lgamma(freedom / 2)


def nats_to_be_seen(least: float, parameters: int = 1) -> float:
    """Return what the true values of an effect must gain on average for those that
    other scenes fitted, of errors as large, to gain @least in 95 of 100 sets.

    k parameters that are u errors away gain u^2 / 2, and as fitted (u^2 - k) / 2, with
    a variance of u^2 + 1.5 k."""
    more = 1.5 * parameters
    root = ABOVE95 + math.sqrt(ABOVE95**2 + 2 * least + parameters + more)
    return (root**2 - more) / 2


def limits(
    space: Space,
    gram: Gram,
    names: Sequence[str],
    candidates: Sequence[str],
    least: float,
) -> dict[str, Array | None]:
    """Return the strength that 95 of 100 such sets of scenes would have shown of each
    parameter of the effects that are not named, (k,); None of one that no scene shows.

    Expected gain of a strength is information / 2 times its square."""
    found: dict[str, Array | None] = {}
    chosen = space.index(names)
    for name in candidates:
        own = space.index([name])
        information = np.diagonal(gram.given(own, chosen))
        scale = np.diagonal(gram.information)[own]
        if not (information > 1e-9 * np.maximum(scale, 1e-300)).any():
            found[name] = None
            continue
        needed = 2 * nats_to_be_seen(least, len(own))
        with np.errstate(divide="ignore"):
            found[name] = np.sqrt(needed / np.maximum(information, 0))
    return found
