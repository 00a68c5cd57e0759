# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 3 by a learner of neighbourhoods: a U-net, beside that of pixels."""

from pathlib import Path

import numpy as np

from studies.learners.unet import Examples, train
from studies.learners.unet_denoiser import file_name
from studies.protocol import IspRules, UnetRules
from studies.sources.frames import TestSets
from studies.sources.sets import Draw, Sources
from studies.tasks.isp import (
    GOALS,
    Array,
    Developer,
    Errors,
    Learner,
    Pairs,
    channels_first,
    isp_draw,
)


def isp_unet_draw(draw: Draw, made: Sources, tests: TestSets) -> Errors:
    """Return the Measures of U-nets, of the sources that the protocol names."""
    rules = draw.world.protocol.isp_unet
    few = {source: made[source] for source in rules.sources}
    folder = draw.folder and draw.folder / "unet"
    learner = unet_learner(rules, draw.world.protocol.isp, draw.mode, folder)
    return isp_draw(draw, few, tests, learner)


def unet_learner(
    rules: UnetRules, isp: IspRules, mode: str, folder: Path | None
) -> Learner:
    """Return the Learner of a U-net, which learns how pictures differ from the input.

    mode : quick or full. folder : of checkpoints."""

    def learner(own: Pairs, seed: int, name: str) -> Developer:
        count = round(len(own.inputs) * isp.validation)
        goals = channels_first(own.both())
        examples = Examples(repeated(own.inputs), goals, count, residual=True)
        path = None if folder is None else folder / f"{file_name(name)}.pt"
        trained = train(examples, rules, rules.steps[mode], seed, path)
        return lambda inputs: np.moveaxis(trained(repeated(inputs)), 1, -1)

    return learner


def repeated(inputs: Array) -> Array:
    """Return inputs (n, h, w, 3), once for each goal, channels first."""
    return channels_first(np.concatenate([inputs] * len(GOALS), axis=-1))
