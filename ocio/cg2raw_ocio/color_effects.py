# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which effects of a sensor are part of its RAW spaces: those of the stage color.

They are linear in camera RGB and the same for all pixels, so that a matrix holds them;
what each does is asked of the core. No other effect can be a colour space."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cg2raw import _core
from cg2raw.arrays import FloatImage
from cg2raw.exposure import Run, core_run

Setting = dict[str, Any]  # name and parameters of an effect

STAGE = "color"
# A matrix of a larger condition number is no way back from float32.
LARGEST_CONDITION = 1e4


def matrix(profile: _core.SensorProfile, illuminant: str) -> NDArray[np.float64] | None:
    """Return (3, 3) float64: camera RGB -> the same with the profile's effects of stage
    color under an illuminant (a word); None if it has none.

    Raises ValueError for effects that the core refuses, and if there is no way back."""
    settings = settings_of(profile)
    if not settings:
        return None
    result = np.eye(3)
    for setting in settings:
        result = applied(profile, illuminant, np.eye(3), [setting]).T @ result
    if not np.linalg.cond(result) <= LARGEST_CONDITION:
        names = ", ".join(setting["name"] for setting in settings)
        raise ValueError(
            f"sensor {profile.id}: under {illuminant} camera RGB cannot be had back "
            f"from its effects {names}, and a RAW space needs that: weaken them"
        )
    return result


def applied(
    profile: _core.SensorProfile,
    illuminant: str,
    camera: ArrayLike,
    settings: Sequence[Setting] | None = None,
) -> FloatImage:
    """Return (n, 3) float32 camera RGB with those effects, by the core.

    settings : those of the profile, or a part of them."""
    run = core_run(profile.id, Run(illuminant=illuminant))
    planes = np.array(np.transpose(camera), np.float32, order="C")[:, None]
    for setting in settings_of(profile) if settings is None else settings:
        planes = _core.apply_effect(
            profile, planes, setting["name"], setting["parameters"], run
        )
    return planes[:, 0].T


def settings_of(profile: _core.SensorProfile) -> list[Setting]:
    """Return the profile's effects of stage color in the order of application.

    Raises ValueError for one that is unknown or given twice."""
    return sorted(
        (s for s in known(profile) if ORDER[s["name"]][0] == STAGE),
        key=lambda setting: ORDER[setting["name"]][1],
    )


def left_to_the_writer(profile: _core.SensorProfile) -> list[str]:
    """Return the names of all other effects, as the profile lists them."""
    return [s["name"] for s in known(profile) if ORDER[s["name"]][0] != STAGE]


def known(profile: _core.SensorProfile) -> list[Setting]:
    """Return the profile's effects. Raises ValueError: see settings_of."""
    names = [setting["name"] for setting in profile.effects]
    for name in names:
        if name not in ORDER:
            raise ValueError(
                f'sensor {profile.id}: effect "{name}" is unknown; known: '
                f"{', '.join(ORDER)}"
            )
        if names.count(name) > 1:
            raise ValueError(
                f"sensor {profile.id}: effect {name} would act twice: list it once"
            )
    return profile.effects


# Stage and place of each effect in the order of application.
ORDER = {
    effect["name"]: (effect["stage"], place)
    for place, effect in enumerate(_core.effects())
}
