# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Capture sets with hidden effects, to try the diagnosis on."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from cg2raw.diagnose.captures import Capture, CaptureSet
from cg2raw.diagnose.hidden_truth import conditions
from cg2raw.diagnose.hidden_truth.camera import camera_of
from cg2raw.diagnose.hidden_truth.strengths import draw_effect
from cg2raw.diagnose.hidden_truth.world import GROUPS, World, plan, stream

ILLUMINANT = "D65"


def simulate_captures(
    sensor: Any,
    hidden: Mapping[str, Mapping[str, float]],
    *,
    seed: int,
    shape: tuple[int, int] = (112, 144),
    illuminant: str = ILLUMINANT,
    iso: float | None = None,
    full_well: float | None = None,
    read_noise: float | None = None,
    groups: tuple[str, ...] = GROUPS,
    nuisances: Mapping[str, float] | None = None,
) -> CaptureSet:
    """Return frames that a Sensor would take if it had hidden effects.

    hidden : effect -> the generator's own parameters, as draw_hidden returns them.
    seed : of scenes, patterns and noise; what is hidden does not change the scenes.
    shape : (H, W), even, at least 48.
    iso : of the profile's noise; None for the first it has, or where full_well and
        read_noise, in electrons, stand for a noise that it lacks.
    groups : of GROUPS, 8 frames each.
    nuisances : of conditions.STUDIO: what else is wrong with the captures.

    log_density of the captures is that of the model that drew them, which knows the
    nuisances too. Raises ValueError."""
    world = world_of(
        sensor, hidden, seed, shape, illuminant, iso, full_well, read_noise, nuisances
    )
    captures = [
        Capture(
            name=shot.name,
            kind=shot.kind,
            shape=world.shape,
            group=shot.group,
            set=shot.set,
            illuminant=illuminant,
            iso=iso if full_well else noise_iso(sensor, iso),
            exposure_time=shot.seconds,
            raw=partial(world.raw, shot),
            scene=partial(world.render, shot),
            log_density=partial(world.log_density, shot),
        )
        for shot in plan(seed, groups)
    ]
    return CaptureSet(
        sensor=sensor,
        captures=captures,
        nuisances=conditions.declared(world.nuisances),
        uncertainty=conditions.uncertainty(world.nuisances),
    )


def world_of(
    sensor: Any,
    hidden: Mapping[str, Mapping[str, float]],
    seed: int,
    shape: tuple[int, int],
    illuminant: str,
    iso: float | None,
    full_well: float | None,
    read_noise: float | None,
    nuisances: Mapping[str, float] | None,
) -> World:
    """Return the world that draws the frames; arguments as of simulate_captures."""
    if min(shape) < 48 or shape[0] % 2 or shape[1] % 2:
        raise ValueError(f"shape {tuple(shape)} must be even and at least 48 x 48")
    if not full_well:
        iso = noise_iso(sensor, iso)
    camera = camera_of(
        sensor, illuminant, None if full_well else iso, full_well, read_noise
    )
    for name, values in hidden.items():
        wanted = draw_effect(name, stream(seed, name), camera)
        if set(values) != set(wanted):
            raise ValueError(
                f"hidden effect {name} needs {', '.join(wanted)}, not "
                f"{', '.join(values)}"
            )
    given = conditions.checked(nuisances)
    return World(camera, hidden, seed, (int(shape[0]), int(shape[1])), given)


def noise_iso(sensor: Any, iso: float | None) -> float:
    """Return the ISO of the noise to be simulated."""
    if iso is not None:
        return iso
    if not sensor.noise:
        raise ValueError(
            f"sensor {sensor.id} has no measured noise: give full_well and read_noise "
            "in electrons"
        )
    return float(sensor.noise[0]["iso"])


def draw_hidden(
    sensor: Any,
    strengths: Mapping[str, float | None],
    *,
    seed: int,
    illuminant: str = ILLUMINANT,
    iso: float | None = None,
    full_well: float | None = None,
    read_noise: float | None = None,
) -> dict[str, dict[str, float]]:
    """Return the parameters of hidden effects, for simulate_captures.

    strengths : effect -> its strength, in the unit of strengths.KINDS; None to draw it.
    Other arguments as of simulate_captures. Raises ValueError."""
    if not full_well:
        iso = noise_iso(sensor, iso)
    camera = camera_of(
        sensor, illuminant, None if full_well else iso, full_well, read_noise
    )
    return {
        name: draw_effect(name, stream(seed, f"strength/{name}"), camera, strength)
        for name, strength in strengths.items()
    }
