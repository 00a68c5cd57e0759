# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Tails: a share of the read noise is wider than the rest."""

from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.model import Model


def tails_of(model: Model, frame: Frame) -> tuple[float, float]:
    """Return (share, variance ratio) of noise that is wider than the rest."""
    for effect in every().values():
        values = model.values_of(effect, frame) if effect.whitening else None
        tails = None if values is None else effect.tails(values)
        if tails is not None:
            return tails
    return 0.0, 1.0
