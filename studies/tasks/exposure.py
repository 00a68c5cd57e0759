# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the exposure of renders is worth: studies 2 and 3, each source at its own.

Sources are those of sources.exposures; what a render's exposure clips stays clipped."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

from studies.sources.frames import TestSets
from studies.sources.sets import Draw, Sources
from studies.tasks.denoising import denoising_draw
from studies.tasks.isp import isp_draw

ISP = "neural ISP"


def exposure_draw(
    draw: Draw, made: Sources, tests: TestSets
) -> dict[str, Mapping[str, Any]]:
    """Return the Measures of ISP, and Scores by condition of denoising, by tests."""
    protocol = draw.world.protocol
    own = protocol.exposures
    rules = replace(protocol.denoising, isos=own.isos, brightness=own.brightness)
    world = replace(draw.world, protocol=replace(protocol, denoising=rules))
    kept = {source: cache(make) for source, make in made.items()}
    developed = isp_draw(draw, kept, tests, own_exposure=True)
    denoised = denoising_draw(replace(draw, world=world), kept, tests, arms=(True,))
    return {name: {ISP: developed[name], **denoised[name]} for name in tests}
