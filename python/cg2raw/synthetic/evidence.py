# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""How much the frames that decide tell of a hidden effect, at best."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cg2raw.synthetic.world import Shot, World, plan


class _Without(World):
    """A world that lacks one effect, and is shown the frames of one that has it."""

    def __init__(self, world: World, name: str) -> None:
        rest = {key: values for key, values in world.hidden.items() if key != name}
        super().__init__(world.camera, rest, world.seed, world.shape, world.nuisances)
        self._shown = world

    def raw(self, shot: Shot) -> NDArray[np.uint16]:
        return self._shown.raw(shot)


def evidence(world: World, names: Iterable[str]) -> dict[str, float]:
    """Return, per effect, the nats by which the select frames are likelier with it.

    Both worlds are known to the last parameter: what a diagnosis, which has to fit
    them, can gain is less."""
    shots = [shot for shot in plan(world.seed) if shot.group == "select"]

    def total(one: World) -> float:
        return sum(float(np.nansum(one.log_density(s), dtype=float)) for s in shots)

    with_all = total(world)
    return {name: with_all - total(_Without(world, name)) for name in names}
