# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The description of one scene. Metres, z up, the camera looks to +y; radians.

Colours are linear Rec.709. A description is plain data: it goes into a frame's JSON."""

from dataclasses import asdict, dataclass, field

Point = tuple[float, float, float]
Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """Where the camera stands and looks; focal length in mm on 36 mm."""

    place: Point
    target: Point
    focal_length: float


@dataclass(frozen=True)
class Sky:
    """Radiances above the horizon and overhead; the moon's irradiance in W/m^2."""

    name: str
    horizon: Rgb
    zenith: Rgb
    moon: float
    moon_from: Point


@dataclass(frozen=True)
class Weather:
    """Wetness of the ground, 0 dry to 1 puddles; scattering of the air per metre."""

    wet: float
    haze: float


@dataclass(frozen=True)
class Lamp:
    """A white lamp: kelvin, Duv from the black body, power in W of Blender."""

    name: str
    place: Point
    turn: float
    kelvin: float
    duv: float
    power: float
    size: float = 1.0


@dataclass(frozen=True)
class Sign:
    """Neon or a lit board: hue and saturation 0..1, radiance, letters' height in m."""

    name: str
    text: str
    place: Point
    turn: float
    hue: float
    saturation: float
    radiance: float
    size: float


@dataclass(frozen=True)
class Vehicle:
    """What stands on the road, its front to -y before its turn; lamps on or off."""

    body: str
    place: Point
    turn: float
    paint: Rgb
    lit: bool


@dataclass(frozen=True)
class Person:
    """A figure of some height in m that faces -y before its turn."""

    pose: str
    place: Point
    turn: float
    height: float
    coat: Rgb
    trousers: Rgb
    umbrella: bool = False


@dataclass(frozen=True)
class Thing:
    """Anything else, by the name of its shape in parts/things.py."""

    name: str
    place: Point
    turn: float
    size: Point
    shade: Rgb
    seed: int = 0


@dataclass(frozen=True)
class House:
    """One house of a row, between two distances along it."""

    start: float
    end: float
    storeys: int
    wall: str
    shade: Rgb
    shop: bool
    shop_kelvin: float
    shop_power: float


@dataclass(frozen=True)
class Row:
    """Houses that run along +y of their own frame and look to -side of its x."""

    place: Point
    turn: float
    side: int
    houses: tuple[House, ...]


@dataclass(frozen=True)
class Tower:
    """A distant house with a grid of windows, of which a share is lit."""

    place: Point
    size: Point
    shade: Rgb
    lit: float
    kelvin: float
    radiance: float
    seed: int


@dataclass(frozen=True)
class Festoon:
    """A string of bulbs between two points, sagging by some metres."""

    start: Point
    end: Point
    sag: float
    count: int
    colours: tuple[Rgb, ...]


@dataclass(frozen=True)
class Scene:
    """All that is built, and where the picture is taken from."""

    index: int
    kind: str
    layout: str
    stage: dict
    camera: Camera
    sky: Sky
    weather: Weather
    rows: tuple[Row, ...] = ()
    towers: tuple[Tower, ...] = ()
    lamps: tuple[Lamp, ...] = ()
    signs: tuple[Sign, ...] = ()
    festoons: tuple[Festoon, ...] = ()
    vehicles: tuple[Vehicle, ...] = ()
    people: tuple[Person, ...] = ()
    things: tuple[Thing, ...] = field(default=())

    def as_json(self):
        """Return the description as JSON's types."""
        return rounded(asdict(self))


def rounded(value):
    """Return JSON's types with numbers of four decimals: the index has the rest."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, tuple | list):
        return [rounded(each) for each in value]
    return round(value, 4) if isinstance(value, float) else value
