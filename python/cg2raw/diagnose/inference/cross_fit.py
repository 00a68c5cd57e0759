# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Cross fit: tails of noise, by frames that had no part in the maps beside them.

A map follows the outliers of the frames that it was made of: what is left of them there
is less than the noise has, and frames that repeat them show a part of it. So a part of
the frames tells the tails beside maps that the others made, one part after the other.
Source: V. Chernozhukov et al., Econometrics Journal 21(1), 2018.
"""

from collections.abc import Sequence
from dataclasses import replace

from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.coordinate_search import best_values, fit_transform
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

PARTS = 4
FEWEST_MAKERS = 2 * PARTS


def fit_beside_maps(model: Model, name: str, likelihood: Likelihood) -> Model:
    """Return the model with the best values of a transform: of one that makes tails,
    where frames made maps, beside maps of others."""
    term = model.term(name)
    assert term is not None
    makers = _by_light(likelihood.frames)
    if (
        term.effect.tails(term.values) is None
        or not list(model.maps)
        or len(makers) < FEWEST_MAKERS
    ):
        return fit_transform(model, name, likelihood)[0]
    parts = []
    for part in range(PARTS):
        others = [f for n, f in enumerate(makers) if n % PARTS != part]
        of_others = fit_patterns(model, likelihood.of(others))
        held_out = likelihood.of([_held_out(f) for f in makers[part::PARTS]])
        parts.append((of_others, held_out, held_out.predictions(of_others)))

    def score(values: Values) -> float:
        return sum(
            held_out.total(of_others.with_values(name, values), known)
            for of_others, held_out, known in parts
        )

    return model.with_values(name, best_values(term, score)[0])


def _by_light(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames that make maps, those that repeat each other side by side."""
    makers = [frame for frame in frames if frame.capture.group == "fit"]
    return sorted(makers, key=lambda f: (f.capture.kind, f.seconds, f.capture.name))


def _held_out(frame: Frame) -> Frame:
    return replace(frame, capture=replace(frame.capture, group="select"))
