# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Capture sets with hidden effects, to try the diagnosis on."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from numpy.random import Generator

from cg2raw import Sensor
from cg2raw.diagnose.captures.capture import Capture, CaptureSet, Group
from cg2raw.synthetic import conditions, disk
from cg2raw.synthetic.camera import Camera, camera_of
from cg2raw.synthetic.measured import Measured
from cg2raw.synthetic.sensors import ASSUMED, ISO, with_noise
from cg2raw.synthetic.strengths import (
    DRAWN_AS,
    KINDS,
    UNKNOWN_KINDS,
    draw_effect,
)
from cg2raw.synthetic.synthetic_camera import GROUPS, SyntheticCamera, plan, stream

ILLUMINANT = "D65"
SHAPE = (112, 144)
# Stand-ins for a sensor whose noise nobody has measured, electrons.
FULL_WELL, READ_NOISE = 10000.0, 5.0
# Its median is in the profile: what differs from pixel to pixel is hidden.
UNEVEN = "dark_current_nonuniformity"


def simulate_captures(
    sensor: Sensor,
    hidden: Mapping[str, Mapping[str, float]],
    *,
    seed: int,
    shape: tuple[int, int] = SHAPE,
    illuminant: str = ILLUMINANT,
    iso: float | None = None,
    groups: tuple[Group, ...] = GROUPS,
    nuisances: Mapping[str, float] | None = None,
    measured: Measured | None = None,
    twice: bool = False,
) -> CaptureSet:
    """Return frames that a Sensor would take if it had hidden effects.

    hidden : effect -> the generator's own parameters, as draw_hidden returns them.
    seed : of scenes, patterns and noise; what is hidden does not change the scenes.
    shape : (H, W), even, at least 48.
    iso : of the profile's noise; None for the first it has.
    groups : of GROUPS, 8 frames each.
    nuisances : of conditions.STUDIO: what else is wrong with the captures.
    measured : a real lens or read noise that is hidden too.
    twice : darks and flats are taken twice, as scenes are: 12 frames per group.

    Raises ValueError."""
    iso = noise_iso(sensor, iso)
    source = synthetic_camera_of(
        sensor, hidden, seed, shape, illuminant, iso, nuisances, measured, twice
    )
    captures = [
        Capture(
            name=shot.name,
            kind=shot.kind,
            shape=source.shape,
            group=shot.group,
            set=shot.set,
            illuminant=illuminant,
            iso=iso,
            exposure_time=shot.seconds,
            raw=partial(source.raw, shot),
            scene=partial(source.render, shot),
        )
        for shot in plan(seed, groups, twice)
    ]
    return CaptureSet(
        sensor=doubted(sensor, source.camera),
        captures=captures,
        nuisances=conditions.declared(source.nuisances),
        uncertainty=conditions.uncertainty(source.nuisances),
    )


def doubted(sensor: Sensor, camera: Camera) -> Sensor:
    """Return the sensor that captures come with: it has the dark current that the
    camera's profile knows of."""
    if not camera.dark:
        return sensor
    profile = json.loads(sensor.to_json())
    per_second = float((camera.dark / camera.full_well).mean())
    effect = {"name": "dark_current", "parameters": {"per_second": per_second}}
    profile["effects"] = [*profile.get("effects", []), effect]
    return Sensor.from_json(json.dumps(profile), sensor.id)


def synthetic_camera_of(
    sensor: Sensor,
    hidden: Mapping[str, Mapping[str, float]],
    seed: int,
    shape: tuple[int, int],
    illuminant: str,
    iso: float,
    nuisances: Mapping[str, float] | None,
    measured: Measured | None = None,
    twice: bool = False,
) -> SyntheticCamera:
    """Return the camera that draws the frames; arguments as of simulate_captures."""
    if min(shape) < 48 or shape[0] % 2 or shape[1] % 2:
        raise ValueError(
            f"size {shape[1]}x{shape[0]} px: both sides must be even, and 48 at least"
        )
    camera = camera_of(sensor, illuminant, iso)
    if UNEVEN in hidden:
        camera = replace(camera, dark=hidden[UNEVEN]["electrons_per_second"])
    for name, values in hidden.items():
        wanted = draw_effect(name, stream(seed, name), camera)
        if set(values) != set(wanted):
            raise ValueError(
                f"hidden effect {name} needs {', '.join(wanted)}, not "
                f"{', '.join(values)}"
            )
    given = conditions.checked(nuisances)
    field = None if measured is None else measured.transmission
    if field is not None and (field.shape != tuple(shape) or not (field >= 0).all()):
        raise ValueError(
            f"measured transmission, {field.shape}, must have the frames' shape "
            f"{tuple(shape)} and no value below 0"
        )
    size = (int(shape[0]), int(shape[1]))
    return SyntheticCamera(camera, hidden, seed, size, given, measured, twice)


def noise_iso(sensor: Sensor, iso: float | None) -> float:
    """Return the ISO of the noise to be simulated. Raises ValueError for none."""
    if not sensor.noise:
        raise ValueError(
            f"sensor {sensor.id} has no measured noise; take one that has, or give it "
            "a full well and a read noise"
        )
    return float(sensor.noise[0]["iso"]) if iso is None else iso


def draw_hidden(
    sensor: Sensor,
    strengths: Mapping[str, float | None],
    *,
    seed: int,
    illuminant: str = ILLUMINANT,
    iso: float | None = None,
) -> dict[str, dict[str, float]]:
    """Return the parameters of hidden effects, for simulate_captures.

    strengths : effect -> its strength, in the unit of strengths.KINDS; None to draw it.
    Other arguments as of simulate_captures. Raises ValueError."""
    camera = camera_of(sensor, illuminant, noise_iso(sensor, iso))
    return {
        name: draw_effect(name, strength_stream(seed, name), camera, strength)
        for name, strength in strengths.items()
    }


def strength_stream(seed: int, name: str) -> Generator:
    """Return the random numbers that decide an effect's parameters."""
    return stream(seed, f"strength/{DRAWN_AS.get(name, name)}")


def strengths_of(text: str, seed: int) -> dict[str, float | None]:
    """Return effect -> strength of "NAME=STRENGTH,NAME,..."; "random" is any one name.

    Raises ValueError."""
    strengths: dict[str, float | None] = {}
    for word in filter(None, text.split(",")):
        name, given, value = word.partition("=")
        if name == "random":
            left = [one for one in KINDS if one not in strengths]
            name = str(stream(seed, f"random/{len(strengths)}").choice(left))
        if name in strengths:
            raise ValueError(f"--effects names {name} twice")
        try:
            strengths[name] = float(value) if given else None
        except ValueError:
            raise ValueError(f"--effects {word}: {value!r} is no number") from None
    return strengths


def strength_lines() -> list[str]:
    """Return a line for each effect that can be hidden: its range of strengths, and
    what they are; then those that no diagnosis names."""
    ranges = [
        [
            f"  {name:30}{kind.low:g}..{kind.high:g}  {kind.strength}"
            for name, kind in kinds.items()
        ]
        for kinds in (KINDS, UNKNOWN_KINDS)
    ]
    return [*ranges[0], "and effects that no diagnosis names:", *ranges[1]]


@dataclass(frozen=True)
class Synthesis:
    """What synthesize makes. effects : NAME[=STRENGTH],...; random is any one. size :
    "WxH" px. iso : of the sensor's noise; None for its first. full_well, read_noise :
    electrons, in place of the sensor's noise; None for that, or, if it has none,
    FULL_WELL and READ_NOISE. studio : with what goes wrong in a studio."""

    sensor: str
    effects: str
    seed: int
    size: str
    illuminant: str
    iso: float | None
    full_well: float | None
    read_noise: float | None
    studio: bool

    def folder(self) -> disk.Folder:
        """Return the capture set. Raises ValueError."""
        sensor, name = self._doubted
        iso = noise_iso(sensor, self.iso)
        strengths = strengths_of(self.effects, self.seed)
        hidden = draw_hidden(
            sensor, strengths, seed=self.seed, illuminant=self.illuminant, iso=iso
        )
        source = synthetic_camera_of(
            sensor,
            hidden,
            self.seed,
            self._shape,
            self.illuminant,
            iso,
            conditions.STUDIO if self.studio else None,
            twice=True,
        )
        known = doubted(sensor, source.camera)
        name = name if known is sensor else disk.SENSOR
        return disk.Folder(source, source.shots, known, name, self.illuminant, iso)

    @property
    def _shape(self) -> tuple[int, int]:
        width, by, height = self.size.partition("x")
        if not (by and width.isdecimal() and height.isdecimal()):
            raise ValueError(
                f"--size {self.size}: must be WxH in pixels, as in 720x480"
            )
        return int(height), int(width)

    @property
    def _doubted(self) -> tuple[Sensor, str]:
        """The doubted model and what captures.yaml calls it."""
        sensor = Sensor(self.sensor)
        assumed = self.full_well is not None or self.read_noise is not None
        if sensor.noise and not assumed:
            is_file = self.sensor.endswith(".json")
            return sensor, disk.SENSOR if is_file else self.sensor
        full_well = FULL_WELL if self.full_well is None else self.full_well
        read_noise = READ_NOISE if self.read_noise is None else self.read_noise
        iso = ISO if self.iso is None else self.iso
        return with_noise(sensor, full_well, read_noise, iso), disk.SENSOR


def notes_of(folder: disk.Folder) -> list[str]:
    """Return sentences on what a capture set assumes."""
    assumed = dict(folder.sensor.sources).get("noise", "")
    if not assumed.startswith(ASSUMED):
        return []
    return [f"{folder.sensor.id}: noise {assumed}, in {disk.SENSOR}"]
