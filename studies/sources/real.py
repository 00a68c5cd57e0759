# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source real: what the camera sees of the spectra."""

from collections.abc import Sequence

import numpy as np

from studies.sources.frames import Frames
from studies.world.colorimetry import Array
from studies.world.colouring import observed, seen
from studies.world.scene import Shot
from studies.world.shots import neutrals


def real(shots: Sequence[Shot], sensitivities: Array) -> Frames:
    """Return the Frames of shots by sensitivities (81, 3); neutrals: of main lights."""
    images = [seen(shot, sensitivities) for shot in shots]
    mains = np.array([shot.lights[0] for shot in shots])
    scenes = tuple(
        observed(shot) * np.float32(green)
        for shot, green in zip(shots, mains @ sensitivities[:, 1], strict=True)
    )
    return Frames(images, neutrals(mains, sensitivities), scenes=scenes)
