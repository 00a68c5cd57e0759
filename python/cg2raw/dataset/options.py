# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which options of the command make which Plan."""

import json
from collections.abc import Callable, Sequence
from typing import Any

from cg2raw import Sensor, __version__
from cg2raw.cfa import is_mono, sites_of
from cg2raw.dataset.methods import METHODS, Scene
from cg2raw.dataset.plan import Plan, short
from cg2raw.spectra import is_estimate

# The option that decides a field of the plan, for messages.
OPTIONS = {
    "digital_gains": "--digital-gain",
    "isos": "--iso",
    "exposure_time": "--exposure-time",
    "white_luminance": "--white-luminance",
    "element_type": "--type",
    "profiles": "--sensors (the profiles)",
    "space": "--iscolorspace",
}

# Fields of a Run that need others, which images have.
WITHOUT_LIGHT = {
    "scene_luminance": None,
    "nd_filter": 0.0,
    "time_limits": None,
    "f_number_limits": None,
}


def make_plan(
    sensors: Sequence[Sensor], leave_out: Callable[[str], None], **fields: Any
) -> Plan:
    """Return the Plan of Sensors.

    sensors : (Sensor, ...). leave_out : called with a sentence on each sensor or ISO
    that cannot be and is left out, or raises. fields : those of Plan but sensors and
    profiles.
    Raises ValueError naming option, value and remedy."""
    if fields["format"] == "exr" and fields["element_type"] == "uint16":
        raise ValueError("--type uint16: not in EXR; --type float32, or --format npy")
    kept = [
        sensor
        for sensor in sensors
        if fits(sensor, fields["format"], leave_out)
        and has_lights(sensor, fields, leave_out)
    ]
    plan = plan_of(kept, fields)
    for isos, reasons in unknown_noise(plan).items():
        why = "they have no noise model there"
        if len(reasons) == 1:
            (why,) = reasons.values()
        leave_out(f"--iso {isos}: not with {', '.join(reasons)}: {why}")
    plan = plan_of([camera for camera in kept if plan.exposures[camera.id]], fields)
    if not plan.sensors:
        raise ValueError("--sensors: none is left that can do what was asked")
    for camera in plan.cameras.values():
        check_runs(plan, camera)
    return plan


def unknown_noise(plan: Plan) -> dict[str, dict[str, str]]:
    """Return {"100,3200": {sensor: why its noise there is not known}}."""
    found: dict[str, dict[str, str]] = {}
    for id, camera in plan.cameras.items():
        known = [(iso, plan.why_not(camera, iso)) for iso in plan.isos]
        bad = {iso: why for iso, why in known if iso is not None and why is not None}
        if bad:
            why = next(iter(bad.values()))
            found.setdefault(",".join(map(short, bad)), {})[id] = why
    return found


def plan_of(sensors: Sequence[Sensor], fields: dict[str, Any]) -> Plan:
    """Return the Plan of Sensors."""
    profiles = {sensor.id: sensor.to_json() for sensor in sensors}
    return Plan(sensors=tuple(profiles), profiles=profiles, **fields)


def fits(sensor: Sensor, format: str, leave_out: Callable[[str], None]) -> bool:
    """Return whether a format can hold the sensor's mosaic."""
    if format == "dng" or len(sites_of(sensor.cfa)) == 4:
        return True
    leave_out(
        f"--format {format}: packs 2x2 Bayer sites, and {sensor.id} has another CFA; "
        "leave it out of --sensors, or --format dng"
    )
    return False


def has_lights(
    sensor: Sensor, fields: dict[str, Any], leave_out: Callable[[str], None]
) -> bool:
    """Return whether the sensor has lights to draw; named ones all have.

    fields : of Plan. Raises ValueError if it says how to draw, and names lights."""
    illuminants = fields["illuminants"]
    measured = fields.get("light_draws", "sample") == "measured"
    if measured and (fields["method"] == "upi" or not isinstance(illuminants, int)):
        raise ValueError(
            "--light-draws measured: lights are drawn only by a number of "
            "--illuminants, and not with --method upi; name them, as measured:0-9"
        )
    if not isinstance(illuminants, int):
        return True
    if not is_mono(sensor.cfa):
        return not measured or has_measured(sensor, leave_out)
    leave_out(
        f"--illuminants {illuminants}: draws neutrals, and {sensor.id} is monochrome "
        "and has none; leave it out of --sensors, or name one light, as D65"
    )
    return False


def has_measured(sensor: Sensor, leave_out: Callable[[str], None]) -> bool:
    """Return whether the sensor's profile holds the neutrals themselves."""
    try:
        sensor.illuminant("measured:0")
    except ValueError as error:
        leave_out(f"--light-draws measured: {error}")
        return False
    return True


def check_runs(plan: Plan, sensor: Sensor) -> None:
    """Raise ValueError for a combination that cannot be simulated."""
    words = plan.illuminants
    if isinstance(words, int):
        words = (f"{plan.light_draws}:0",)
    elif any(map(is_estimate, words)):  # of spectra, which each image has or has not
        words = tuple(w for w in words if not is_estimate(w)) or ("D65",)
    elif plan.method == "upi":
        raise ValueError(
            "--illuminants: --method upi draws the light itself; say how many"
        )
    gains = [1.0 if gain == "sample" else gain for gain in plan.digital_gains]
    own = plan.method == "graphics2raw"
    if own and "sample" in plan.digital_gains and sensor.digital_gain is None:
        raise ValueError(
            f"--digital-gain sample: {sensor.id} has no digital_gain to sample from; "
            "give numbers, or leave it out of --sensors"
        )
    isos = plan.exposures[sensor.id]
    # An option at a time: what they do is independent.
    tries = [(word, gains[0], isos[0]) for word in words]
    tries += [(words[0], gain, isos[0]) for gain in gains]
    tries += [(words[0], gains[0], iso) for iso in isos]
    for word, gain, iso in tries:
        camera = METHODS[plan.method](sensor, Scene("", 0, word, gain, 0), plan.seed)
        # Each image tells later whether it says its time and aperture.
        run = plan.run(camera, iso, plan.exposure_time or 1.0) | WITHOUT_LIGHT
        camera.sensor.simulation((2, 2), **run, meter=1.0)


def difference(old_text: str, plan: Plan) -> str | None:
    """Return how dataset.json differs from @plan in one sentence, None if it does not.

    Raises ValueError if it is no dataset.json."""
    try:
        old = json.loads(old_text)
        version = old["cg2raw"]
        if version != __version__:
            return f"was made by cg2raw {version}, this is {__version__}"
    except (ValueError, KeyError, TypeError):
        raise ValueError("dataset.json is damaged") from None
    if "folders" not in old:
        return (
            "was begun by an older cg2raw, which called folders as image files "
            "(interior.exr/, not interior/)"
        )
    new = json.loads(plan.to_json())
    del new["profile_sha256"]  # of profiles, which are compared themselves
    for name in new:
        if old.get(name) == new[name]:
            continue
        option = OPTIONS.get(name, f"--{name}")
        if name == "profiles":
            return f"{option} have changed since it was begun"
        return f"was begun with {option} {said(old.get(name))}, not {said(new[name])}"
    return None


def said(value: Any) -> str:
    """Return a plan's value as it is on a command line."""
    if isinstance(value, list):
        return ",".join("clean" if one is None else str(one) for one in value)
    return str(value)
