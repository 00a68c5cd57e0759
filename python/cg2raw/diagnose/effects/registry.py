# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Registry: the effects that the core simulates, as it describes them, and which of
them profiles list."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.sensor import Sensor


@cache
def registered(cfa: str | None = None) -> Mapping[str, Mapping[str, Any]]:
    """Return the registry's effects by name, in the order in which they act.

    cfa : only what a monochrome sensor has, with its parameters. Others have all: what
    the registry lacks of larger repeats, the prediction adds."""
    of = cfa if cfa is not None and is_mono(cfa) else None
    return {effect["name"]: effect for effect in _core.effects(of)}


def unit_of(name: str, parameter: str, cfa: str | None) -> str:
    """Return the unit of an effect's parameter; "1" where the registry has none."""
    known = registered(cfa)[name]["parameters"]
    return next((p["unit"] for p in known if p["name"] == parameter), "1")


def listed_values(sensor: Sensor, name: str) -> tuple[float, ...] | None:
    """Return the parameters of an effect that a profile lists, in the registry's order;
    None if it does not."""
    listed = listed_parameters(sensor, name)
    return None if listed is None else tuple(listed.values())


def listed_parameters(sensor: Sensor, name: str) -> dict[str, float] | None:
    """Return the same by their names."""
    for effect in sensor.effects:
        if effect["name"] == name:
            return stated_by(effect, None)
    return None


def stated_by(entry: Mapping[str, Any], cfa: str | None) -> dict[str, float]:
    """Return all parameters of an entry of a profile, in the registry's order."""
    return {
        known["name"]: float(entry["parameters"].get(known["name"], known["null"]))
        for known in registered(cfa)[entry["name"]]["parameters"]
    }


def draw_noise_by(profile: dict[str, Any], name: str, gaussian: str) -> None:
    """Let an effect draw a profile's noise in the place of the Gaussian one."""
    drawn = profile.get("noise_effects", ["shot_noise", "read_noise"])
    profile["noise_effects"] = [name if one == gaussian else one for one in drawn]
