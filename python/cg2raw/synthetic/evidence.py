# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Evidence: how much the select frames can say about a hidden effect, at best."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cg2raw.synthetic.synthetic_camera import Shot, SyntheticCamera


class _Without(SyntheticCamera):
    """A camera that lacks one effect, and is shown the frames of one that has it."""

    def __init__(self, source: SyntheticCamera, name: str) -> None:
        rest = {key: values for key, values in source.hidden.items() if key != name}
        super().__init__(
            source.camera,
            rest,
            source.seed,
            source.shape,
            source.nuisances,
            twice=source.twice,
        )
        self._shown = source

    def raw(self, shot: Shot) -> NDArray[np.uint16]:
        return self._shown.raw(shot)


def evidence(source: SyntheticCamera, names: Iterable[str]) -> dict[str, float]:
    """Return, per effect, the nats by which the select frames are likelier with it.

    Both cameras are known to the last parameter: what a diagnosis, which has to fit
    them, can gain is less."""
    shots = [shot for shot in source.shots if shot.group == "select"]

    def total(one: SyntheticCamera) -> float:
        return sum(float(np.nansum(one.log_density(s), dtype=float)) for s in shots)

    with_all = total(source)
    return {name: with_all - total(_Without(source, name)) for name in names}
