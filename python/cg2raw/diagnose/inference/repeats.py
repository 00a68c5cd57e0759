# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Repeats: what differs between frames that repeat each other is noise.

In the difference of two darks or flats all fixed patterns cancel, and so does what a
model lacks of their mean: slow structure that is left of it makes neighbours as alike
as noise that correlates does. Source: EMVA Standard 1288, release 4.0, section 8.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict


def repeats(frames: Sequence[Frame]) -> Iterator[list[Frame]]:
    """Yield the uniform frames of each kind, exposure and ISO, that are not cut."""
    alike: dict[tuple[object, ...], list[Frame]] = {}
    for frame in frames:
        capture = frame.capture
        if not (capture.shows.image or frame.is_cut):
            key = capture.kind, capture.exposure_time, capture.iso, capture.shape
            alike.setdefault(key, []).append(frame)
    yield from alike.values()


def difference(model: Model, pair: tuple[Frame, Frame]) -> Frame:
    """Return the first of two repeats with the difference of both in the place of what
    a model leaves of it: noise as strong as that of either, and nothing else."""
    first, second = pair
    means = predict(model, first).mean, predict(model, second).mean
    rest = (first.signal - means[0]) - (second.signal - means[1])
    return replace(
        first,
        signal=means[0] + rest / np.sqrt(2),
        keep=first.keep & second.keep & ~first.censored & ~second.censored,
    )


def evidence_of_noise(model: Model, rest: Model, splits: Splits) -> float | None:
    """Return the nats that select frames gain by noise in which a model differs from
    another, where those that repeat each other count by their differences; None where
    none do.

    Half as many differences as frames do not depend on each other: they count twice."""
    select = splits.select
    pairs = [
        pair
        for members in repeats(select.frames)
        for pair in zip(members[::2], members[1::2], strict=False)
        if pair[0].signal.shape == pair[1].signal.shape
    ]
    if not pairs:
        return None
    paired = {id(frame) for pair in pairs for frame in pair}
    alone = [frame for frame in select.frames if id(frame) not in paired]
    own = select.workers.map(lambda pair: difference(rest, pair), pairs)
    return _gain(model, rest, select.of(alone)) + 2 * _gain(model, rest, select.of(own))


def _gain(model: Model, rest: Model, likelihood: Likelihood) -> float:
    return likelihood.total(model) - likelihood.total(rest)
