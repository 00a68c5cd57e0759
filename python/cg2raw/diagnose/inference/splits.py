# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Splits: which frames fit a model, which select it, which it is reported on."""

from collections.abc import Sequence
from functools import cached_property

from cg2raw.diagnose.captures.capture import Group
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.workers import Workers


class Splits:
    """All frames of a diagnosis, in order, and the likelihood of each split."""

    def __init__(self, frames: Sequence[Frame], workers: Workers) -> None:
        self.frames = tuple(frames)
        self.workers = workers

    def check(self) -> None:
        """Raise ValueError if a split has no frame."""
        for name, members in self.by_name.items():
            if not members.frames:
                raise ValueError(
                    f"no frame is in the group {name}: not enough to fit, select and "
                    "report on different frames; add frames"
                )

    @cached_property
    def by_name(self) -> dict[Group, Likelihood]:
        return {
            group: Likelihood(
                [f for f in self.frames if f.capture.group == group], self.workers
            )
            for group in GROUPS
        }

    @property
    def fit(self) -> Likelihood:
        return self.by_name["fit"]

    @property
    def select(self) -> Likelihood:
        return self.by_name["select"]

    @property
    def report(self) -> Likelihood:
        return self.by_name["report"]

    @property
    def of_nuisances(self) -> Likelihood:
        """What tells the size of nuisances: the fit frames, and all tables of patches.
        How wrong a chart's colours are is one number, and a split has few patches."""
        others = [f for f in self.frames if f.samples is not None]
        others = [frame for frame in others if frame.capture.group != "fit"]
        return self.fit.of([*self.fit.frames, *others])

    @property
    def names(self) -> dict[str, list[str]]:
        """Names of the frames of each split."""
        return {
            split: [frame.capture.name for frame in members.frames]
            for split, members in self.by_name.items()
        }

    @property
    def hold_out_frames(self) -> bool:
        """Whether frames select that no fit has seen. If frames are divided by their
        pixels, each is in all splits, with what its pixels share."""
        shots = {id(frame.capture.raw) for frame in self.fit.frames}
        return any(id(frame.capture.raw) not in shots for frame in self.select.frames)

    def placed(self, registration: Registration) -> "Splits":
        """Return the same frames with their renders where a registration found them."""
        return Splits(self.workers.map(registration.placed, self.frames), self.workers)
