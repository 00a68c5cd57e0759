# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Full wells: as full as the light of a frame makes them.

Light that a frame has by normal numbers of its own, as a wave of flicker, whitening
integrates out as what is linear. A well is not: of pixels that are expected full, a
dimmer wave shows some that are not. So the well is filled by the likeliest light, and
the signal is linear about that, by Laplace's method.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.shared_fields import SharedFields
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.noise_model import LEAST_VARIANCE
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.frames.well import Well
from cg2raw.diagnose.likelihood.model import Model

MOST_STEPS_OF_LIGHT = 12
MOST_HALVINGS = 10  # of a step
LIGHT_AT_REST = 1e-4  # standard deviations of the light, of a last step


def cut_by_well(
    model: Model,
    frame: Frame,
    mean: Array,
    variance: Array,
    well: Well,
) -> tuple[Array, Array, Well]:
    """Return (mean, variance, full well) with the well as full as the light of the
    frame makes it, before that is added."""
    uncut = np.stack([mean, variance]) + well.cut
    seen = frame.signal - uncut[0] + well.charge
    filled, bent = _filled_by_light(well, model, frame, seen, uncut[1])
    mean, variance = uncut - filled.cut
    return mean + bent, variance, filled


def _filled_by_light(
    well: Well, model: Model, frame: Frame, seen: Array, variance: Array
) -> tuple[Well, Array | float]:
    """Return (the well as the likeliest light of a frame fills it, what the signal has
    there beyond what is linear in this light).

    seen : (T, h, w), the signal of charge alone. variance : of it, if no well were
        full."""
    if not frame.capture.shows.light or frame.samples is not None or not well.any_near:
        return well, 0.0
    lit = np.maximum(well.charge, 0)
    fields = [(field * lit).ravel() for field in _relative_fields(model, frame)]
    if not fields:
        return well, 0.0
    used = (frame.keep & ~frame.censored).ravel()
    light = Light(well, np.array(fields), seen, variance, used)
    for _ in range(MOST_STEPS_OF_LIGHT):
        if light.step() < LIGHT_AT_REST:
            break
    full, charge = light.well, light.charge
    shown = full.below * charge
    return replace(full, light=shown), charge - shown


def _relative_fields(model: Model, frame: Frame) -> Iterator[Array | float]:
    if model.nuisance is not None:
        yield from model.nuisance.levels(frame)
    for effect in every().values():
        if isinstance(effect, SharedFields):
            values = model.values_of(effect, frame)
            if values is not None:
                yield from effect.light(values, frame)


class Light:
    """The likeliest numbers of fields of charge (k, pixels), which are normal, of
    variance 1, and fill a well of which a signal is seen: by Gauss and Newton's method.

    seen, variance : (T, h, w), the signal of charge alone, and its variance if no well
    were full, by which it is weighed: full pixels, that vary less, tell of no light.
    used : (pixels,), which of them count."""

    def __init__(
        self, well: Well, fields: Array, seen: Array, variance: Array, used: Array
    ) -> None:
        self._empty, self._fields, self._seen = well, fields, seen
        self._weight = used / np.maximum(variance, LEAST_VARIANCE).ravel()
        self._fill(np.zeros(len(fields)))

    @property
    def charge(self) -> Array:
        charge: Array = (self.numbers @ self._fields).reshape(self._seen.shape)
        return charge

    def step(self) -> float:
        """Take a step; return its largest part, 0 at the top.

        A step that leaves more is too long, and is halved: it may have filled pixels
        that are not full."""
        before, cost = self.numbers, self.cost
        slopes = self._fields * self.well.below.ravel()
        bend = np.eye(len(slopes)) + (slopes * self._weight) @ slopes.T
        pull = (slopes * self._weight) @ self._left - before
        moved = np.linalg.solve(bend, pull)
        for _ in range(MOST_HALVINGS):
            self._fill(before + moved)
            if self.cost <= cost:
                return float(np.abs(moved).max())
            moved = moved / 2
        self._fill(before)
        return 0.0

    def _fill(self, numbers: Array) -> None:
        """Fill the well by numbers of the fields. cost : twice the nats that these and
        what they leave of the signal lose."""
        self.numbers = numbers
        self.well = self._empty.with_more(self.charge)
        self._left = (self._seen - self.well.charge + self.well.cut[0]).ravel()
        self.cost = float(self._weight @ self._left**2 + numbers @ numbers)
